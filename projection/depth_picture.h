#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "planning_io/types/camera_model.h"
#include "planning_io/types/triangle_mesh.h"

namespace planlight {

/// How deep the skin lies behind each small block of projector pixels: a cheap first answer to "is this point in the
/// shadow of other skin", made anew for each pose from a thinned mesh.
class DepthPicture {
public:
    explicit DepthPicture(const TriangleMesh& mesh);

    /// `projector_from_ct`: the projector's model with ct in the place of rig.
    void draw(const CameraModel& projector_from_ct);

    enum class Answer { lit, hidden, near_an_edge };
    /// For a skin point seen at `pixel`, `depth_mm` before the projector.
    Answer ask(const Eigen::Vector2d& pixel, double depth_mm) const;

    std::size_t triangle_count() const { return triangles_.size(); }

private:
    void draw_triangle(const Eigen::Vector3d& p, const Eigen::Vector3d& q, const Eigen::Vector3d& r);

    std::vector<Eigen::Vector3d> vertices_in_ct_;
    std::vector<std::array<std::int32_t, 3>> triangles_;
    int width_ = 0, height_ = 0;
    std::vector<float> inverse_depth_;   ///< per block, of the nearest skin, 1/mm; 0 where there is none
    std::vector<Eigen::Vector3d> seen_;  ///< per vertex: block column, row, 1 / depth (0: not seen)
};

}  // namespace planlight
