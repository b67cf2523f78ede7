#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "planning_io/types/rigid_transform.h"
#include "planning_io/types/skin_lut.h"

namespace planlight {

/// The failure function's table: truncated distance to the skin on a 4 mm grid, small enough for the processor's cache.
/// Nearest voxel, no interpolation; beyond the table is the truncation. Outside of the body less counts than inside. A
/// point whose nearest skin is the end of the volume is unknown, not wrong: it counts at least a third of the
/// truncation.
class CoarseDistance {
public:
    CoarseDistance(const SkinLut& lut, double truncation_mm, double truncation_outside_mm);

    /// Sum over the points, in mm; stops early, with a value of at least `limit_mm`, when the sum exceeds it.
    float sum(std::span<const Eigen::Vector3f> points_in_rig, const Eigen::Matrix3f& R, const Eigen::Vector3f& t,
              float limit_mm) const;

private:
    Eigen::Vector3i size_;
    Eigen::Vector3f origin_in_ct_;
    float mm_per_step_;
    std::vector<std::uint8_t> steps_;
};

}  // namespace planlight
