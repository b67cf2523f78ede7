#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "segmentation/voxel_morphology.h"

namespace planlight {

/// A volume seen coarsely: cubic voxels along the axes of ct (i to the patient's left, j to the back, k to the head),
/// each the mean of eight places, so that size, turn and noise of the scanner's own voxels matter little to what is
/// judged on it.
struct HeadSurvey {
    VoxelGrid grid;
    Eigen::Vector3d first_in_ct = Eigen::Vector3d::Zero();  ///< centre of voxel (0,0,0), mm
    std::vector<float> values;                              ///< 0 where nothing was measured
    Mask measured;                                          ///< 1 where the volume reaches
    Mask rim;  ///< 1 along the twelve edges of the volume's own box; where none shows anything, of one within

    double step_mm() const { return grid.spacing_mm.x(); }
    std::size_t index(int i, int j, int k) const {
        return static_cast<std::size_t>(k) * grid.slab() + static_cast<std::size_t>(j) * grid.row() +
               static_cast<std::size_t>(i);
    }
    bool has_rim() const;                               ///< else air finds no way in
    Eigen::Vector3d place_of(std::size_t index) const;  ///< centre of a voxel in ct
};

/// How coarsely a volume is looked at.
struct SurveySettings {
    double step_mm = 2;
    std::size_t most_voxels = 4'000'000;  ///< a larger space has a larger step
};

/// Values that are not finite count as not measured.
HeadSurvey survey_of(const Volume& volume, const SurveySettings& settings = {});

/// Each value the mean of its neighbourhood (weights 1 2 1 along each axis), of measured voxels only.
std::vector<float> smoothed(const HeadSurvey& survey, const std::vector<float>& values);

}  // namespace planlight
