#pragma once

#include <Eigen/Core>
#include <vector>

#include "planning_io/types/plan.h"

namespace planlight {

/// The points of an item that must lie near the skin.
inline std::vector<Eigen::Vector3d> skin_points(const Trajectory& t) {
    return {t.entry_in_ct};
}
inline std::vector<Eigen::Vector3d> skin_points(const Borehole& b) {
    return {b.position_in_ct};
}
inline std::vector<Eigen::Vector3d> skin_points(const OsteotomyLine& o) {
    return o.points_in_ct;
}
inline std::vector<Eigen::Vector3d> skin_points(const CutPlane&) {
    return {};
}

}  // namespace planlight
