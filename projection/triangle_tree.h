#pragma once

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <Eigen/Core>
#include <vector>

// CGAL's tree over triangles. Heavy: for the .cpp files of projection alone.
namespace planlight::triangle_tree {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

inline Kernel::Point_3 to_cgal(const Eigen::Vector3d& p) {
    return {p.x(), p.y(), p.z()};
}
inline Eigen::Vector3d to_eigen(const Kernel::Point_3& p) {
    return {p.x(), p.y(), p.z()};
}

}  // namespace planlight::triangle_tree
