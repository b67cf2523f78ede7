#include "registration/tracking/track_patient.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "planning_io/types/error.h"
#include "registration/tracking/fit_pose.h"
#include "registration/tracking/largest_error.h"
#include "registration/tracking/match_constellation.h"
#include "registration/tracking/pair_markers.h"

namespace planlight {
namespace {

void check_size(const GrayImage& picture, const CameraModel& camera, const char* side) {
    if (picture.width == camera.width && picture.height == camera.height) return;
    throw InputError({},
                     fmt::format("the {} picture is {}x{}, but the rig was calibrated with {}x{}", side, picture.width,
                                 picture.height, camera.width, camera.height),
                     "Use the camera mode the rig was calibrated in, or calibrate again.");
}

/// Radius at which a marker is to be expected that was not seen before: between facing (1) and tilted by 60 degrees
/// (0.75).
double expected_radius_px(const CameraModel& camera, const Eigen::Vector3d& p_in_rig, const MarkerDesign& design) {
    return 0.9 * 0.5 * design.disc_diameter_mm * camera.focal_x / (camera.device_from_rig * p_in_rig).z();
}

/// How much of a pair's sigma is noise: the rest is the same in every later picture, and no error against the
/// reference.
double share_of_noise(const MarkerObservation& left, const MarkerObservation& right) {
    const double steady = std::hypot(left.steady_px, right.steady_px), all = std::hypot(left.sigma_px, right.sigma_px);
    return all > steady ? std::sqrt(1 - steady * steady / (all * all)) : 1;
}

/// Of several measurements of one disc for different markers the nearest to its marker's predicted place stays.
std::vector<Sighting> one_disc_one_marker(std::vector<std::pair<double, Sighting>> found) {
    std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<Sighting> sightings;
    for (const auto& [distance, sighting] : found) {
        const bool already_sighted =
            std::any_of(sightings.begin(), sightings.end(), [&s = sighting](const Sighting& other) {
                return (other.seen.pixel - s.seen.pixel).norm() < 0.5 * s.seen.radius_px;
            });
        if (!already_sighted) sightings.push_back(sighting);
    }
    return sightings;
}

bool doubted(const CheckedPose& checked, int marker) {
    return std::ranges::any_of(checked.doubts, [&](const MarkerDoubt& d) { return d.marker == marker; });
}

bool back_in_place(const CheckedPose& checked, int marker) {
    return std::ranges::find(checked.in_place_again, marker) != checked.in_place_again.end();
}

}  // namespace

/// A way to the pose of one frame, and all discs seen on it.
struct PatientTracker::Attempt {
    CheckedPose checked;
    std::vector<Seen> left, right;
};

TrackingSettings tracking_settings_for(const MarkerDesign& design) {
    TrackingSettings settings;
    settings.design = design;
    settings.markers.sticker_ratio = design.sticker_diameter_mm / design.disc_diameter_mm;
    return settings;
}

PatientTracker::PatientTracker(const RigCalibration& rig, const TrackingSettings& settings)
    : rig_(rig), settings_(settings) {
    settings_.markers.sticker_ratio = settings.design.sticker_diameter_mm / settings.design.disc_diameter_mm;
}

const std::vector<PatientMarker>& PatientTracker::set_reference(const StereoFrame& frame) {
    check_size(frame.left, rig_.left_camera, "left");
    check_size(frame.right, rig_.right_camera, "right");
    const auto left = find_markers(frame.left, settings_.markers), right = find_markers(frame.right, settings_.markers);
    const auto possible = possible_pairs(rig_, left, right, settings_.design, settings_.max_epipolar_px);
    const auto pairs = consistent_pairs(possible, static_cast<int>(left.size()), static_cast<int>(right.size()));
    std::vector<PatientMarker> markers;
    for (const MarkerPair& p : pairs)
        markers.push_back({p.centre_in_rig, p.sigma_mm * share_of_noise(left[static_cast<std::size_t>(p.left)],
                                                                        right[static_cast<std::size_t>(p.right)])});
    set_reference(markers);
    for (const auto& m : left) seen_left_.push_back({m, -1});
    for (const auto& m : right) seen_right_.push_back({m, -1});
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        Seen& in_left = seen_left_[static_cast<std::size_t>(pairs[k].left)];
        Seen& in_right = seen_right_[static_cast<std::size_t>(pairs[k].right)];
        in_left.marker = in_right.marker = static_cast<int>(k);
        radius_left_px_[k] = in_left.left_or_right.radius_px;
        radius_right_px_[k] = in_right.left_or_right.radius_px;
    }
    if (static_cast<int>(pairs.size()) >= settings_.min_markers) {
        last_ = TrackedPose{};
        last_->rig_from_patient = last_known_ = RigidTransform::Identity();
        last_->at = frame.at;
    }
    return markers_;
}

void PatientTracker::set_reference(std::vector<PatientMarker> markers) {
    markers_ = std::move(markers);
    places_.clear();
    uncertainty_.reset();
    seen_left_.clear();
    seen_right_.clear();
    doubts_.clear();
    standing_.assign(markers_.size(), {});
    radius_left_px_.assign(markers_.size(), 0);
    radius_right_px_.assign(markers_.size(), 0);
    last_.reset();
    before_last_.reset();
    last_known_.reset();
}

void PatientTracker::set_places(const std::vector<Eigen::Vector3d>& places_in_patient) {
    places_ = outermost(places_in_patient);
}

Eigen::Vector3d PatientTracker::centroid() const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const PatientMarker& m : markers_) sum += m.centre_in_patient;
    return sum / static_cast<double>(markers_.size());
}

/// Constant velocity from the last two poses; the last pose when they lie too far apart in time to tell one.
RigidTransform PatientTracker::predicted_pose(Instant at) const {
    const RigidTransform& last = *last_->rig_from_patient;
    if (!before_last_) return last;
    const double before_s = seconds(last_->at - before_last_->at), ahead_s = seconds(at - last_->at);
    if (before_s <= 0 || ahead_s <= 0 || ahead_s > 3 * before_s || ahead_s > 0.2) return last;
    const RigidTransform& earlier = *before_last_->rig_from_patient;
    const double ahead = ahead_s / before_s;
    const Eigen::Vector3d c = centroid(), c_now = last * c;
    Eigen::Matrix<double, 6, 1> twist;
    twist << ahead * rotation_vector(last.linear() * earlier.linear().transpose()), ahead * (c_now - earlier * c);
    return Eigen::Translation3d(c_now) * transform_from_twist(twist) * Eigen::Translation3d(-c_now) * last;
}

PatientTracker::Attempt PatientTracker::follow(const StereoFrame& frame) {
    Attempt attempt;
    const RigidTransform expected = predicted_pose(frame.at);
    std::vector<Sighting> sightings;
    for (const bool is_left : {true, false}) {
        const CameraModel& camera = is_left ? rig_.left_camera : rig_.right_camera;
        const std::vector<double>& radius = is_left ? radius_left_px_ : radius_right_px_;
        std::vector<std::pair<double, Sighting>> found;
        for (std::size_t k = 0; k < markers_.size(); ++k) {
            const Eigen::Vector3d p = expected * markers_[k].centre_in_patient;
            const auto pixel = project(camera, p);
            if (!pixel || !in_picture(camera, *pixel)) continue;
            const double r = radius[k] > 0 ? radius[k] : expected_radius_px(camera, p, settings_.design);
            const auto seen =
                measure_marker(is_left ? frame.left : frame.right, *pixel, r, settings_.search_px, settings_.markers);
            if (seen) found.push_back({(seen->pixel - *pixel).norm(), {static_cast<int>(k), is_left, *seen}});
        }
        for (const Sighting& s : one_disc_one_marker(found)) {
            sightings.push_back(s);
            (is_left ? attempt.left : attempt.right).push_back({s.seen, s.marker});
        }
    }
    attempt.checked = fit_pose_checked(rig_, markers_, sightings, expected, settings_, places_, set_aside());
    if (attempt.checked.fit) look_again(frame, attempt);
    return attempt;
}

/// What was not found where it was expected may stand where the pose now says: after a jump along one camera's line of
/// sight that camera finds everything and the other nothing. Twice, for the first markers of the other camera make the
/// pose a better one to look by.
void PatientTracker::look_again(const StereoFrame& frame, Attempt& attempt) const {
    constexpr double kLeast_px = 4, kMost_px = 15;
    for (int round = 0; round < 2; ++round) {
        std::vector<Sighting> sightings = attempt.checked.used;
        const RigidTransform pose = attempt.checked.fit->rig_from_patient;
        const auto known = [&](int marker, bool left) {
            const auto same = [&](const Sighting& s) { return s.marker == marker && s.left == left; };
            return std::any_of(sightings.begin(), sightings.end(), same) || doubted(attempt.checked, marker) ||
                   back_in_place(attempt.checked, marker);
        };
        std::vector<Sighting> more;
        for (const bool is_left : {true, false}) {
            const CameraModel& camera = is_left ? rig_.left_camera : rig_.right_camera;
            const std::vector<double>& radius = is_left ? radius_left_px_ : radius_right_px_;
            for (std::size_t k = 0; k < markers_.size(); ++k) {
                if (known(static_cast<int>(k), is_left)) continue;
                const Eigen::Vector3d p = pose * markers_[k].centre_in_patient;
                const auto pixel = project(camera, p);
                if (!pixel || !in_picture(camera, *pixel)) continue;
                const double px_per_mm = camera.focal_x / (camera.device_from_rig * p).z();
                const double bound_mm = predicted_error(attempt.checked.fit->uncertainty, p).bound_95_mm;
                const double reach_px = std::clamp(2 * bound_mm * px_per_mm, kLeast_px, kMost_px);
                const double r = radius[k] > 0 ? radius[k] : expected_radius_px(camera, p, settings_.design);
                const auto seen =
                    measure_marker(is_left ? frame.left : frame.right, *pixel, r, reach_px, settings_.markers);
                if (seen) more.push_back({static_cast<int>(k), is_left, *seen});
            }
        }
        if (more.empty()) return;
        sightings.insert(sightings.end(), more.begin(), more.end());
        CheckedPose better = fit_pose_checked(rig_, markers_, sightings, pose, settings_, places_, set_aside());
        if (!better.fit || better.used.size() <= attempt.checked.used.size()) return;
        for (const MarkerDoubt& d : attempt.checked.doubts)
            if (!doubted(better, d.marker)) better.doubts.push_back(d);
        better.in_place_again.insert(better.in_place_again.end(), attempt.checked.in_place_again.begin(),
                                     attempt.checked.in_place_again.end());
        attempt.checked = std::move(better);
        for (const Sighting& s : more) (s.left ? attempt.left : attempt.right).push_back({s.seen, s.marker});
    }
}

/// A pose from one camera alone is weak along its line of sight: before it is accepted both pictures are searched
/// whole, and from time to time again as long as it stays so.
bool PatientTracker::worth_a_search(const Attempt& followed) const {
    constexpr int kEvery = 8;
    const auto by_left = std::count_if(followed.checked.used.begin(), followed.checked.used.end(),
                                       [](const Sighting& s) { return s.left; });
    const bool one_camera = by_left == 0 || by_left == static_cast<std::ptrdiff_t>(followed.checked.used.size());
    return one_camera && followed_by_one_ % kEvery == 0;
}

PatientTracker::Attempt PatientTracker::search(const StereoFrame& frame) {
    Attempt attempt;
    const auto left = find_markers(frame.left, settings_.markers), right = find_markers(frame.right, settings_.markers);
    const auto match = match_constellation(rig_, markers_, left, right, last_known_, settings_);
    attempt.checked.reason = match.reason;
    if (match.rig_from_patient)
        attempt.checked =
            fit_pose_checked(rig_, markers_, match.sightings, *match.rig_from_patient, settings_, places_, set_aside());
    // A marker that is known to have slipped still shows the arrangement.
    const std::vector<int> aside = set_aside();
    const auto slipped = std::ranges::count_if(
        aside, [&](int marker) { return doubted(attempt.checked, marker) || back_in_place(attempt.checked, marker); });
    if (attempt.checked.fit && distinct_markers(attempt.checked.used) + slipped < match.needed) {
        attempt.checked.fit.reset();
        attempt.checked.reason = "the discs seen are not in the arrangement of the markers";
    }
    for (const auto& m : left) attempt.left.push_back({m, -1});
    for (const auto& m : right) attempt.right.push_back({m, -1});
    for (const Sighting& s : match.sightings)
        for (Seen& seen : s.left ? attempt.left : attempt.right)
            if (seen.left_or_right.pixel == s.seen.pixel) seen.marker = s.marker;
    return attempt;
}

void PatientTracker::note_seen(const Attempt& attempt) {
    seen_left_ = attempt.left;
    seen_right_ = attempt.right;
    doubts_ = attempt.checked.doubts;
    for (const Sighting& s : attempt.checked.used)
        (s.left ? radius_left_px_ : radius_right_px_)[static_cast<std::size_t>(s.marker)] = s.seen.radius_px;
}

void PatientTracker::note_moved(const Attempt& attempt) {
    const CheckedPose& checked = attempt.checked;
    for (const MarkerDoubt& doubt : checked.doubts) {
        Standing& of = standing_[static_cast<std::size_t>(doubt.marker)];
        of.in_place = 0;
        if (doubt.certain && ++of.moved >= settings_.set_aside_after) of.aside = true;
    }
    for (const Sighting& s : checked.used) standing_[static_cast<std::size_t>(s.marker)].moved = 0;
    for (const int marker : checked.in_place_again) {
        Standing& of = standing_[static_cast<std::size_t>(marker)];
        if (++of.in_place >= settings_.set_aside_after) of = {};
    }
}

std::vector<int> PatientTracker::set_aside() const {
    std::vector<int> markers;
    for (std::size_t k = 0; k < standing_.size(); ++k)
        if (standing_[k].aside) markers.push_back(static_cast<int>(k));
    return markers;
}

TrackedPose PatientTracker::update(const StereoFrame& frame) {
    check_size(frame.left, rig_.left_camera, "left");
    check_size(frame.right, rig_.right_camera, "right");
    TrackedPose pose;
    pose.at = frame.at;
    if (static_cast<int>(markers_.size()) < settings_.min_markers) {
        pose.reason =
            fmt::format("the reference has {} markers; {} are needed", markers_.size(), settings_.min_markers);
        return pose;
    }
    Attempt attempt;
    if (last_) attempt = follow(frame);
    bool followed = attempt.checked.fit.has_value();
    if (!followed) {
        attempt = search(frame);
    } else if (worth_a_search(attempt)) {
        Attempt whole = search(frame);
        if (whole.checked.fit && whole.checked.fit->bound_95_mm < attempt.checked.fit->bound_95_mm)
            attempt = std::move(whole), followed = false;
    }
    note_seen(attempt);
    uncertainty_.reset();
    if (!attempt.checked.fit) {
        pose.reason = attempt.checked.reason;
        last_.reset();
        before_last_.reset();
        return pose;
    }
    note_moved(attempt);
    const PoseFit& fit = *attempt.checked.fit;
    pose.rig_from_patient = last_known_ = fit.rig_from_patient;
    uncertainty_ = fit.uncertainty;
    pose.residual_px = fit.residual_px;
    pose.predicted_error_mm = fit.error_mm;
    pose.bound_95_mm = fit.bound_95_mm;
    pose.external_reliability_mm = fit.external_reliability_mm;
    for (const Sighting& s : attempt.checked.used) ++(s.left ? pose.markers_left : pose.markers_right);
    followed_by_one_ = pose.markers_left == 0 || pose.markers_right == 0 ? followed_by_one_ + 1 : 0;
    before_last_ = followed ? last_ : std::nullopt;
    last_ = pose;
    return pose;
}

}  // namespace planlight
