#pragma once

#include <vector>

#include "planning_io/types/rig_calibration.h"

namespace planlight::test {

/// How wrong a rig is, place by place.
struct RigError {
    /// Of a point that both cameras see without noise, as the rig places it; a common turn and shift is taken out, for
    /// it cancels between scan and light.
    std::vector<double> points_mm;
    std::vector<double> light_mm;  ///< of where light lands that is sent to such a point
};

/// At the points (in the truth's rig frame, mm) that all true devices see. The rigs may have different frames.
RigError rig_error(const RigCalibration& found, const RigCalibration& truth,
                   const std::vector<Eigen::Vector3d>& points);

/// The corners of a board of 10 x 7 squares of 25 mm that lies there.
void add_board_points(const RigidTransform& rig_from_board, std::vector<Eigen::Vector3d>& points);

}  // namespace planlight::test
