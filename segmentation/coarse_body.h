#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "planning_io/types/triangle_mesh.h"
#include "planning_io/types/volume.h"
#include "segmentation/head_survey.h"
#include "segmentation/segment_skin.h"

namespace planlight {

/// The body on a coarse grid along ct, one voxel wider than the skin.
struct CoarseBody {
    HeadSurvey places;  ///< its grid; `measured` is 1 where the volume reaches; no values
    Mask body;
    Eigen::Vector3d low_in_ct, high_in_ct;  ///< of the skin
};

/// Beyond the volume lies `beyond` (1 body, 0 air). `skin` has vertices.
CoarseBody coarse_body(const Volume& volume, const SkinMask& mask, const TriangleMesh& skin, double step_mm,
                       std::uint8_t beyond);

}  // namespace planlight
