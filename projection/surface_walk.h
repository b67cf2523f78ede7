#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "planning_io/types/triangle_mesh.h"

namespace planlight {

/// Straight ways over a triangle mesh: within a triangle a line, across an edge the line that unfolding the two
/// triangles makes straight (Polthier & Schmies 1998).
class SurfaceWalk {
public:
    explicit SurfaceWalk(const TriangleMesh& mesh);  ///< keeps a reference

    struct Place {
        int triangle;
        Eigen::Vector3d p_in_ct;
        Eigen::Vector3d direction_in_ct;  ///< unit, in the plane of the triangle
    };
    /// From `start` straight for `length_mm`. `visit(place, way_mm)` is called for each of `stops_mm`, ascending, on
    /// the way. Empty when the way leaves the mesh.
    std::optional<Place> go(Place start, double length_mm, const std::vector<double>& stops_mm,
                            const std::function<void(const Place&)>& visit) const;

    const Eigen::Vector3d& face_normal(int triangle) const { return face_normals_[static_cast<std::size_t>(triangle)]; }

private:
    struct Exit {
        int edge = -1;
        double distance_mm = 0;
    };
    Exit find_exit(const Place& place) const;
    Eigen::Vector3d corner(int triangle, int which) const;
    /// In the triangle's plane, out of it across the edge from corner `edge` to the next; unit.
    Eigen::Vector3d outward(int triangle, int edge) const;
    bool cross(Place& place, int edge) const;

    const TriangleMesh& mesh_;
    std::vector<Eigen::Vector3d> face_normals_;
    std::vector<std::array<std::int32_t, 3>> neighbours_;  ///< across the edge from corner e to e + 1; -1 at a border
};

/// Unit normals per vertex, weighted by the angle of each triangle at it.
std::vector<Eigen::Vector3d> vertex_normals(const TriangleMesh& mesh);

}  // namespace planlight
