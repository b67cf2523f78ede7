#pragma once

#include <optional>
#include <vector>

#include "planning_io/types/rig_calibration.h"
#include "planning_io/types/tracked_pose.h"
#include "registration/devices/stereo_camera.h"
#include "registration/tracking/find_markers.h"
#include "registration/tracking/pose_uncertainty.h"

namespace planlight {

/// What markers must agree to for a pose.
struct TrackingSettings {
    MarkerSettings markers;
    MarkerDesign design;
    int min_markers = 3;                      ///< seen by both cameras together; fewer give no pose
    double max_residual_px = 0.5;             ///< rms above which there is no pose
    double max_epipolar_px = 1.5;             ///< when the markers of both pictures are paired
    double search_px = 40;                    ///< around the predicted place
    double max_predicted_error_mm = 1;        ///< one sigma, the largest where it counts, above which there is no pose
    double max_external_reliability_mm = 10;  ///< of a slip of 1 mm (`external_reliability_mm`); above it, no pose
    int set_aside_after = 5;  ///< poses running without a marker that has moved; as many in its place take it back
};

/// For markers of that design.
TrackingSettings tracking_settings_for(const MarkerDesign& design);

/// A marker that does not stand where it stood against the others: it slipped, or something else was taken for it.
struct MarkerDoubt {
    int marker = -1;          ///< index into the reference markers
    double deviation_mm = 0;  ///< from where the others say it is, across the line of sight
    bool certain = true;      ///< no other marker explains the disagreement as well
};

/// A marker in the patient frame, as measured at the scan instant.
struct PatientMarker {
    Eigen::Vector3d centre_in_patient;
    double sigma_mm = 0;
};

/// Follows the pasted markers in both cameras: T_cur(t) (Hoppe 2001, 2.2).
class PatientTracker {
public:
    PatientTracker(const RigCalibration& rig, const TrackingSettings& settings = {});

    /// Takes the markers of this frame as the reference: `patient` equals `rig` here. Gives the markers found in both
    /// pictures; fewer than `min_markers` leave the tracker without a reference (and `update` without a pose).
    const std::vector<PatientMarker>& set_reference(const StereoFrame& frame);

    /// As above, from markers of an earlier session or a file.
    void set_reference(std::vector<PatientMarker> markers);

    /// Where the pose counts: the plan's points, in patient. What a pose states and is refused by
    /// (`predicted_error_mm`, `bound_95_mm`) is the largest over them; without any, over a sphere of 100 mm about the
    /// markers' middle. A new reference forgets them: they are in its frame.
    void set_places(const std::vector<Eigen::Vector3d>& places_in_patient);

    /// The pose in this frame, by minimising the reprojection in both pictures at once. A lost marker is survived; too
    /// few give no pose, and the next frame is searched whole. A marker that has moved against the others is set aside
    /// once they have told so for some poses, and stays so until they tell that it stands in its place again: among the
    /// few that are left when a hand covers the others it would not show any more.
    TrackedPose update(const StereoFrame& frame);

    const std::vector<PatientMarker>& markers() const { return markers_; }
    /// What was found in the last frame, for the screen; index into `markers()` or -1 for a disc that is none of them.
    struct Seen {
        MarkerObservation left_or_right;
        int marker = -1;
    };
    const std::vector<Seen>& seen_left() const { return seen_left_; }
    const std::vector<Seen>& seen_right() const { return seen_right_; }

    /// The markers that the last pose was made without because they have moved against the others.
    const std::vector<MarkerDoubt>& doubts() const { return doubts_; }

    /// Of the last pose, everywhere (`predicted_error` in largest_error.h); empty when there was none.
    const std::optional<PoseUncertainty>& uncertainty() const { return uncertainty_; }

private:
    struct Attempt;
    Attempt follow(const StereoFrame& frame);
    Attempt search(const StereoFrame& frame);
    void look_again(const StereoFrame& frame, Attempt& attempt) const;
    bool worth_a_search(const Attempt& followed) const;
    RigidTransform predicted_pose(Instant at) const;
    Eigen::Vector3d centroid() const;
    void note_seen(const Attempt& attempt);
    void note_moved(const Attempt& attempt);
    std::vector<int> set_aside() const;

    RigCalibration rig_;
    TrackingSettings settings_;
    std::vector<PatientMarker> markers_;
    std::vector<Eigen::Vector3d> places_;
    std::optional<PoseUncertainty> uncertainty_;
    std::vector<Seen> seen_left_, seen_right_;
    std::vector<MarkerDoubt> doubts_;
    /// Per marker, poses running: that it has moved, and since it was set aside that it stands in its place.
    struct Standing {
        int moved = 0, in_place = 0;
        bool aside = false;
    };
    std::vector<Standing> standing_;
    std::vector<double> radius_left_px_, radius_right_px_;  ///< per marker, as last seen; 0 when never
    std::optional<TrackedPose> last_, before_last_;
    int followed_by_one_ = 0;  ///< frames since both cameras were last searched whole for want of one of them
    std::optional<RigidTransform> last_known_;  ///< survives a loss, to choose between ambiguous arrangements
};

}  // namespace planlight
