#pragma once

#include "planning_io/types/volume.h"

namespace planlight::test {

struct ScanOptions {
    Eigen::Vector3d spacing_mm{1.3, 1.3, 1.6};
    double noise_hu = 15;
    bool objects = true;   ///< table, cushion, two side plates (the left one presses on the ear), a wire on the crown
    bool openings = true;  ///< nostrils, ear canals and a throat that join an air cave behind the nose
    Eigen::Matrix3d ct_from_scan = Eigen::Matrix3d::Identity();  ///< turns the voxel axes against ct
};

/// A CT of the analytic head (tests/support), cut below at z = -75 mm: soft tissue of 40 HU in air of -1000 HU, seen
/// through a scanner's blur of 0.8 mm standard deviation across the skin, with noise.
Volume synthetic_scan(const ScanOptions& options = {});

/// The analytic distance (mm, positive outside) at which that scan crosses `hu` on undisturbed skin.
double crossing_distance_mm(double hu);

inline constexpr double kCutZ_mm = -75;

}  // namespace planlight::test
