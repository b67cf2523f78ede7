#pragma once

#include <array>
#include <optional>
#include <vector>

#include "planning_io/types/rig_calibration.h"
#include "registration/tracking/track_patient.h"

namespace planlight {

/// Whether all discs of one picture went elsewhere at once, and those of the other did not: a head that moves is seen
/// by both cameras, a camera that was knocked sees everything jump alone.
class PictureJumps {
public:
    explicit PictureJumps(const RigCalibration& rig) : rig_(rig) {}

    /// How far the discs of the left and the right picture went beyond going on as before, mm at their depth: the
    /// median over discs that are found again. Empty for the first frames, and where too few are. `depth_mm`: of the
    /// markers before the cameras.
    std::array<std::optional<double>, 2> add(const std::vector<PatientTracker::Seen>& left,
                                             const std::vector<PatientTracker::Seen>& right, double depth_mm);
    void reset();

private:
    struct Side {
        std::vector<Eigen::Vector2d> discs;
        std::optional<Eigen::Vector2d> step;  ///< the last one
        bool jumped = false;
        std::optional<double> add(const std::vector<PatientTracker::Seen>& seen, double mm_per_px);
    };
    RigCalibration rig_;
    std::array<Side, 2> sides_;
};

}  // namespace planlight
