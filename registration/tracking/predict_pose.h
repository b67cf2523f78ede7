#pragma once

#include <memory>
#include <optional>

#include "planning_io/types/tracked_pose.h"

namespace planlight {

/// How far a pose is carried on, and how a head moves.
struct PredictionSettings {
    Instant max_ahead = std::chrono::milliseconds(160);  ///< a pose is not predicted farther than this
    Instant max_gap = std::chrono::milliseconds(150);    ///< older measurements do not carry a velocity
    double acceleration_sigma_mm_s2 = 400;               ///< process noise of the head's movement
    double measurement_sigma_mm = 0.05;
};

/// Where the patient will be when the light arrives: constant-velocity Kalman filter on the pose.
class PosePredictor {
public:
    explicit PosePredictor(const PredictionSettings& settings = {});
    ~PosePredictor();
    PosePredictor(PosePredictor&&) noexcept;
    PosePredictor& operator=(PosePredictor&&) noexcept;

    /// A measured pose; one without `rig_from_patient` is ignored. `centre_in_patient` (mm) is the point about which
    /// the rotation is filtered (the middle of the head), so that translation and rotation do not mix.
    void add(const TrackedPose& pose, const Eigen::Vector3d& centre_in_patient);

    /// The pose at a later moment. Empty before the first measurement, and when `at` is more than `max_ahead` past the
    /// last.
    std::optional<RigidTransform> rig_from_patient_at(Instant at) const;

    void reset();

private:
    struct Filter;
    std::unique_ptr<Filter> filter_;
};

}  // namespace planlight
