#pragma once

#include <array>
#include <vector>

#include "planning_io/types/volume.h"

namespace planlight {

/// What is air and what is skin at a place of an MR, in its own unit: both change over a head with the coils'
/// brightness, with noise, ghosts and the wings of bright fat. On a coarse grid along the axes of ct, linear between
/// its nodes.
struct LevelMap {
    Eigen::Vector3d first_in_ct = Eigen::Vector3d::Zero();  ///< node (0,0,0), mm
    double step_mm = 1;
    std::array<int, 3> size{0, 0, 0};
    std::vector<float> air;   ///< what air shows
    std::vector<float> skin;  ///< from which on it is body; greater than `air`

    std::vector<float> smoothings;  ///< how often noise must be smoothed away before the levels are asked; empty: never

    bool empty() const { return air.empty(); }
};

/// The volume in units of the map: 0 is air, 1 the threshold of the skin. An empty map leaves it as it is.
Volume in_levels(Volume volume, const LevelMap& map);

/// `of` at a place in ct, linear between the nodes, the last ones held beyond; `of` has one value a node.
float value_at(const LevelMap& map, const std::vector<float>& of, const Eigen::Vector3d& at_in_ct);

/// The middle (median) of the map's thresholds, for reports.
double middle_threshold(const LevelMap& map);

}  // namespace planlight
