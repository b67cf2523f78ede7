#pragma once

#include <optional>
#include <string>

#include "planning_io/types/rigid_transform.h"
#include "planning_io/types/time.h"

namespace planlight {

/// The patient at one moment: the paper's T_cur(t), or why there is none.
struct TrackedPose {
    std::optional<RigidTransform> rig_from_patient;  ///< T_cur; identity at the scan instant; empty when not known
    Instant at{};                                    ///< mid-exposure of the frames it was measured in
    int markers_left = 0, markers_right = 0;         ///< used, per camera
    double residual_px = 0;                          ///< rms reprojection over both pictures
    double predicted_error_mm = 0;                   ///< one sigma, the largest where the pose counts
    double bound_95_mm = 0;                          ///< smaller than this in 95 of 100 cases; 0: not known
    /// How far a marker that slips by 1 mm may move it, where it counts, before the others show that; 0: not known.
    double external_reliability_mm = 0;
    std::string reason;  ///< why there is no pose; empty when there is one
};

}  // namespace planlight
