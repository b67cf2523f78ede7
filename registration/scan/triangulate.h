#pragma once

#include <cstddef>

#include "planning_io/types/point_cloud.h"
#include "planning_io/types/rig_calibration.h"
#include "registration/scan/decode_stripes.h"

namespace planlight {

struct TriangulationSettings {
    double camera_sigma_px = 0.15, projector_sigma_px = 0.15;  ///< of a correspondence, for the weights and the covariance
    double max_residual_sigma = 3.5;  ///< three-view agreement: normalised residual above which a point is dropped
    double near_mm = 200, far_mm = 3000;  ///< from the projector: the working volume
    bool one_camera = true;  ///< also points that only one camera and the projector see
};

/// Points from all rays that agree, with counts by reason for those that do not (Fig. 2 of the paper, middle).
struct Triangulation {
    PointCloud cloud;               ///< in rig; one point per left-camera pixel (or right, where only that sees it); no normals yet
    std::vector<Eigen::Vector2i> grid;  ///< per point: the rounded projector pixel (column, row), for neighbourhoods
    std::size_t three_view = 0, two_view = 0;
    std::size_t no_partner = 0, disagree = 0, outside_volume = 0;
};

/// Triangulates the decoded views of both cameras. The views must code both directions, or the columns only when three
/// views meet along epipolar lines.
Triangulation triangulate(const DecodedView& left, const DecodedView& right, const RigCalibration& rig,
                          const TriangulationSettings& settings = {});

}  // namespace planlight
