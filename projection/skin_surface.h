#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "planning_io/types/camera_model.h"
#include "planning_io/types/triangle_mesh.h"

namespace planlight {

/// The skin mesh as something that can be hit by rays and walked on. CGAL lives in the .cpp.
///
/// The constructor throws InputError when the mesh is empty, not finite or names vertices it does not have.
class SkinSurface {
public:
    explicit SkinSurface(TriangleMesh mesh);
    ~SkinSurface();
    SkinSurface(SkinSurface&&) noexcept;
    SkinSurface& operator=(SkinSurface&&) noexcept;

    /// A point on the surface: position and smooth outward normal in ct, mm; the triangle it lies in.
    struct Point {
        Eigen::Vector3d p_in_ct, normal_in_ct;
        int triangle = -1;
    };
    /// The first hit of a ray in ct. Empty when it misses.
    std::optional<Point> first_hit(const Ray& ray_in_ct) const;
    Point nearest(const Eigen::Vector3d& p_in_ct) const;
    /// The skin's outward direction as a hand would take it: of all triangles within `radius_mm` of the point that face
    /// as the skin does there, by their areas. Unit, ct. That of a single place is a voxel's, with its noise.
    Eigen::Vector3d mean_normal(const Point& at, double radius_mm) const;
    /// True when the point is under the skin.
    bool inside(const Eigen::Vector3d& p_in_ct) const;

    /// The point reached by walking straight (geodesic) from `start` by `tangent_in_ct` (its length is the way, mm).
    /// Empty when the way leaves the mesh.
    std::optional<Point> walk(const Point& start, const Eigen::Vector3d& tangent_in_ct) const;

    /// A straight way with points at most `max_segment_mm` apart, its two ends among them, and where it heads at its
    /// end.
    struct Way {
        std::vector<Point> points;
        Eigen::Vector3d direction_at_end_in_ct;  ///< unit, tangent to the skin
    };
    std::optional<Way> walk_way(const Point& start, const Eigen::Vector3d& tangent_in_ct, double max_segment_mm) const;

    /// The place of `point`, which lies on `other`, on this surface: in the same triangle at the same share of its
    /// corners. `other` has the same triangles (one of the two was moved).
    Point same_place(const SkinSurface& other, const Point& point) const;

    /// False on lids over openings and on the end of the volume.
    bool real_skin(const Point& point) const;

    const TriangleMesh& mesh() const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace planlight
