#include "app/session.h"

#include <fmt/format.h>

#include <algorithm>

#include "app/belonging.h"
#include "app/verify_landmarks.h"
#include "planning_io/types/error.h"
#include "projection/skin_now.h"
#include "registration/scan/decode/merge_exposures.h"
#include "registration/tracking/exchanged_cameras.h"
#include "registration/tracking/markers_in_scan.h"

namespace planlight {
namespace {

constexpr int kLeastMoments = 5;  ///< of a scan, in which the markers are seen

/// Where light of the plan lies: both ends and the middle of what is drawn, labels and marks aside, in patient.
std::vector<Eigen::Vector3d> places_of_light(const PlanDrawing& drawing, const RigidTransform& patient_from_ct) {
    std::vector<Eigen::Vector3d> places;
    for (const Stroke& stroke : drawing.strokes) {
        const auto& points = stroke.points_in_ct;
        const bool of_item = stroke.item >= 0 && stroke.kind != StrokeKind::tick && stroke.kind != StrokeKind::label &&
                             stroke.kind != StrokeKind::check_mark;
        if (!of_item || points.empty()) continue;
        for (const auto& p : {points.front(), points[points.size() / 2], points.back()})
            places.push_back(patient_from_ct * p);
    }
    return places;
}

/// What of the drawing is lit while one item is looked at: the labels of all others are dark.
PlanDrawing lit_with(PlanDrawing drawing, std::size_t item, bool others_lit) {
    if (!others_lit)
        std::erase_if(drawing.strokes, [&](const Stroke& stroke) { return stroke.item != static_cast<int>(item); });
    std::erase_if(drawing.labels, [&](const Label& label) { return label.item != static_cast<int>(item); });
    return drawing;
}

double elapsed_s(std::chrono::steady_clock::time_point since) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - since).count();
}

}  // namespace

CaseDrawing::CaseDrawing(const Case& the_case, const DrawingSettings& how)
    : skin(the_case.skin), settings(how), drawing(draw_plan(the_case.plan, skin, settings)) {}

CaseDrawing::CaseDrawing(const Case& the_case, const CaseDrawing& planned, const SkinDisplacement& found)
    : CaseDrawing(the_case, planned, found, planned.settings) {}

CaseDrawing::CaseDrawing(const Case& the_case, const CaseDrawing& planned, const SkinDisplacement& found,
                         const DrawingSettings& how)
    : CaseDrawing(the_case, planned, SkinDisplacementField(found), how) {}

CaseDrawing::CaseDrawing(const Case& the_case, const CaseDrawing& planned, const SkinDisplacementField& found,
                         const DrawingSettings& how)
    : skin(skin_as_scanned(planned.skin.mesh(), found)),
      settings(how),
      drawing(draw_plan(the_case.plan, planned.skin, skin, settings, clearances_in(planned.drawing))) {
    warn_of_unscanned(found, planned.drawing, drawing);
}

DrawingSettings lit_by(const RigCalibration& rig, const RigidTransform& rig_from_ct, DrawingSettings settings) {
    LightView light{rig.projector, rig_from_ct};
    light.steepest = 0.87;  // 50 degrees: whoever looks from beside the projector sees it steeper still
    settings.light = light;
    const Eigen::Vector3d up_in_camera(0, -1, 0);
    if (settings.up_in_ct.isZero())
        settings.up_in_ct =
            rig_from_ct.inverse().linear() * (rig.left_camera.device_from_rig.inverse().linear() * up_in_camera);
    return settings;
}

Session::Session(const Case& the_case, const CaseDrawing& drawing, const RigCalibration& rig, Projector& projector,
                 StereoCamera& cameras, const Clock& clock, SessionSettings settings)
    : case_(the_case),
      planned_(drawing),
      calibrated_(rig),
      rig_(rig),
      devices_(projector, cameras, clock, settings.observer),
      projector_(devices_.projector()),
      cameras_(devices_.cameras()),
      clock_(devices_.clock()),
      settings_(std::move(settings)),
      tracker_(rig_, settings_.tracking),
      renderer_(std::make_unique<DrawingRenderer>(drawing.skin, rig_.projector)) {
    projector_.go_dark();
}

Session::~Session() {
    darken();
}

void Session::darken() noexcept {
    lit_since_ = Instant::max();
    overlay_.reset();
    projector_.go_dark();
}

void Session::make_scan(const std::function<void(int, int)>& progress) {
    darken();
    registration_.reset();
    scanned_.reset();
    rig_state_.reset();
    found_delay_ = {};
    use_rig(calibrated_);
    StripeSettings stripes;
    stripes.width = projector_.width();
    stripes.height = projector_.height();
    for (scans_repeated_ = 0;; ++scans_repeated_) {
        capture_ = capture_scan(projector_, cameras_, clock_, stripes, progress);
        take_reference(*capture_);
        const ScanMovement movement = movement_of_markers(*capture_, rig_, settings_.tracking);
        if (movement.by != ScanMovement::By::markers || movement.moments < kLeastMoments)
            throw CheckFailedError(
                "the markers are not seen in enough pictures of the scan to tell whether the patient lay still",
                "Turn the room's lamps up or the cameras' exposure, and scan again.");
        motion_in_scan_mm_ = std::max(moved_at_the_end_mm(), movement.moved_mm);
        if (motion_in_scan_mm_ <= settings_.max_motion_in_scan_mm) break;
        if (scans_repeated_ + 1 >= settings_.max_scans)
            throw CheckFailedError(
                fmt::format("the patient moved {:.2f} mm during the scan, and in the {} before it as well",
                            motion_in_scan_mm_, scans_repeated_),
                "Have the patient lie still and scan again.");
    }
    std::vector<ScanCapture> exposures;
    exposures.push_back(std::move(*capture_));
    capture_.reset();
    add_darker_captures(projector_, cameras_, clock_, exposures, progress);
    // What moved since the first capture must not be joined to it.
    const auto moved_in = [&](const ScanCapture& exposure) {
        return movement_of_markers(exposure, rig_, settings_.tracking).moved_mm > settings_.max_motion_in_scan_mm;
    };
    if (exposures.size() > 1 && (moved_at_the_end_mm() > settings_.max_motion_in_scan_mm ||
                                 std::any_of(exposures.begin() + 1, exposures.end(), moved_in)))
        exposures.resize(1);
    scanned_ = scan_from_exposures(exposures, calibrated_, settings_.scan);
    capture_ = std::move(exposures.front());
    take_rig(*capture_);
}

void Session::use_rig(const RigCalibration& rig) {
    overlay_.reset();
    rig_ = rig;
    tracker_ = PatientTracker(rig_, settings_.tracking);
    set_hidden({});
    now_.reset();
    renderer_ = std::make_unique<DrawingRenderer>(planned_.skin, rig_.projector);
}

/// From here on everything is done with the rig as the scan found it, or nothing is done.
void Session::take_rig(const ScanCapture& capture) {
    rig_state_ = named_rig_state(*scanned_, calibrated_, capture);
    if (rig_state_->verdict == RigState::Verdict::not_trusted) {
        scanned_.reset();
        throw CheckFailedError("the rig cannot be trusted: " + rig_state_->sentence, rig_state_->remedy);
    }
    use_rig(rig_state_->rig);
    take_reference(capture);
}

/// The markers of the white picture, the first of the scan: `patient` equals `rig` there.
std::size_t Session::reference_markers(const ScanCapture& capture) {
    const StereoFrame white{capture.left.front(), capture.right.front(), capture.began, Instant{}, 0};
    return tracker_.set_reference(white).size();
}

/// Cameras that moved pair no markers: then the scan says where they stand.
void Session::take_reference(const ScanCapture& capture) {
    std::size_t found = reference_markers(capture);
    if (static_cast<int>(found) < settings_.min_reference_markers && !rig_state_) {
        use_rig(scan_from_capture(capture, calibrated_, settings_.scan).rig.rig);
        found = reference_markers(capture);
    }
    if (static_cast<int>(found) < settings_.min_reference_markers)
        throw CheckFailedError(fmt::format("only {} markers were found by both cameras; {} are needed", found,
                                           settings_.min_reference_markers),
                               "Paste markers where both cameras see them, or turn the light up, and scan again.");
}

TrackedPose Session::pose_under_white() {
    const DarkOnExit dark(projector_);
    const RgbImage white(projector_.width(), projector_.height(), {255, 255, 255});
    const Instant lit_from = projector_.show(white, clock_.now() + settings_.patience);
    return tracker_.update(cameras_.grab(lit_from, settings_.patience));
}

/// The paper's patient must not move during the scan; ours is asked once more under white light after the last picture.
double Session::moved_at_the_end_mm() {
    const TrackedPose pose = pose_under_white();
    if (!pose.rig_from_patient)
        throw CheckFailedError("the markers were lost during the scan: " + pose.reason,
                               "Free the markers and scan again.");
    double moved_mm = 0;
    for (const auto& marker : tracker_.markers()) {
        const Eigen::Vector3d& p_in_patient = marker.centre_in_patient;
        moved_mm = std::max(moved_mm, (*pose.rig_from_patient * p_in_patient - p_in_patient).norm());
    }
    return moved_mm;
}

void Session::match(const std::vector<PointPair>& landmarks) {
    if (!scanned_) throw CheckFailedError("there is no scan to find the patient in", "Scan first.");
    RegistrationSettings settings = settings_.registration;
    settings.viewpoint_in_rig = rig_.projector.centre_in_rig();
    confirmed_ = false;
    overlay_.reset();
    landmarks_.reset();
    rig_from_patient_ = RigidTransform::Identity();
    lit_landmark_.reset();
    set_hidden({});
    card_wanted_ = true;
    registration_ = register_with_landmarks(scanned_->clean.kept, case_.lut, landmarks, settings);
    registration_->moved_in_scan_mm = motion_in_scan_mm_;
    take_case_and_rig(case_, rig_state_, *registration_);
    judge_items(planned_.drawing, *registration_);
    if (registration_->verdict != Verdict::no) draw_on_skin_as_found();
    start_overlay();
}

/// On the skin as the scan found it, with the labels beside the markers.
void Session::draw_on_skin_as_found() {
    DrawingSettings drawing = lit_by(rig_, registration_->patient_from_ct, planned_.settings);
    const RigidTransform ct_from_patient = registration_->patient_from_ct.inverse();
    for (const auto& marker : tracker_.markers())
        drawing.keep_clear_in_ct.push_back(ct_from_patient * marker.centre_in_patient);
    now_.emplace(case_, planned_, registration_->skin, drawing);
    set_hidden(hidden_);  // of this drawing
    renderer_ = std::make_unique<DrawingRenderer>(now_->skin, rig_.projector);
}

void Session::start_overlay() {
    auto& keep_dark = settings_.overlay.render.keep_dark_in_patient;
    keep_dark.clear();
    for (const auto& marker : tracker_.markers()) keep_dark.push_back(marker.centre_in_patient);
    settings_.overlay.render.only_item = lit_landmark_ ? static_cast<int>(*lit_landmark_) : -1;
    settings_.overlay.render.item_of_moment =
        item_of_moment_ && !lit_landmark_ ? static_cast<int>(*item_of_moment_) : -1;
    settings_.overlay.render.card = card_wanted() && !lit_landmark_ && !all_hidden();
    overlay_ =
        std::make_unique<OverlayLoop>(projector_, clock_, *renderer_, lit_drawing(), *registration_, settings_.overlay);
    if (confirmed_) overlay_->set_operator_confirmed(true);
    overlay_->set_found_delay(found_delay_);
    overlay_->set_brightness(brightness_.share());
    const auto looked_at = lit_landmark_ ? lit_landmark_ : item_of_moment_;
    const bool others_lit = !lit_landmark_ && settings_.overlay.render.others > 0;
    checker_.emplace(looked_at ? lit_with(lit_drawing(), *looked_at, others_lit) : lit_drawing(), skin_of_light(), rig_,
                     settings_.check_light, looked_at);
    tracker_.set_places(places_of_light(lit_drawing(), registration_->patient_from_ct));
    watch_.emplace(rig_, settings_.light_cause);
    jumps_.emplace(rig_);
    shown_.clear();
    counts_shown_ = {};
    seen_until_ = clock_.now();
    lit_since_ = Instant::max();
}

const std::vector<Eigen::Vector3d>& Session::landmarks() {
    if (landmarks_) return *landmarks_;
    landmarks_ = landmarks_to_verify(skin_of_light(), rig_, rig_from_patient_ * registration_->patient_from_ct);
    Plan plan;
    for (std::size_t i = 0; i < landmarks_->size(); ++i) {
        Borehole ring;
        ring.name = fmt::format("Landmark {}", i + 1);
        ring.position_in_ct = (*landmarks_)[i];
        ring.diameter_mm = kLandmarkRing_mm;
        plan.boreholes.push_back(ring);
    }
    DrawingSettings drawing;
    drawing.labels = false;
    landmark_drawing_ = draw_plan(plan, skin_of_light(), drawing);
    return *landmarks_;
}

Session::Update Session::make_update() {
    if (!registration_) throw CheckFailedError("the patient has not been found", "Scan and register first.");
    if (!overlay_) start_overlay();
    Update update;
    update.frame = next_frame();
    update.received_at = clock_.now();
    const auto began = std::chrono::steady_clock::now();
    update.pose = tracker_.update(update.frame);
    if (update.pose.rig_from_patient) rig_from_patient_ = *update.pose.rig_from_patient;
    update.times.track_s = elapsed_s(began);
    if (settings_.while_computing) settings_.while_computing();
    const auto drawing_began = std::chrono::steady_clock::now();
    update.overlay = overlay_->step(update.pose);
    update.times.draw_s = elapsed_s(drawing_began);
    if (update.overlay.lit) update.swapped_at = clock_.now();
    name_lost_pose(update);
    name_hidden_plan(update);
    update.camera_doubt = cameras_.doubt();
    if (!update.overlay.lit && !update.camera_doubt.empty()) update.overlay.reason += "; " + update.camera_doubt;
    const auto checking_began = std::chrono::steady_clock::now();
    update.light = look_at_light(update);
    if (update.light) overlay_->set_brightness(brightness_.look(*update.light));
    watch_light(update);
    update.times.check_s = elapsed_s(checking_began);
    note_shown(update.overlay);
    correct_delay(update.causes);
    return update;
}

/// The newest exposure after the last one that was used: none is left out because a picture was being drawn.
StereoFrame Session::next_frame() {
    const Instant patience = std::clamp(3 * frame_interval_, Instant(settings_.follow_patience),
                                        std::max(Instant(settings_.patience), Instant(settings_.follow_patience)));
    StereoFrame frame = cameras_.newest(seen_until_, std::chrono::duration_cast<std::chrono::milliseconds>(patience));
    const Instant since = frame.at - seen_at_;
    if (seen_at_ > Instant{} && since > Instant{})
        frame_interval_ = frame_interval_ == Instant{} ? since : std::min(since, frame_interval_ + frame_interval_ / 8);
    seen_at_ = frame.at;
    seen_until_ = frame.at + frame.exposure / 2;
    return frame;
}

/// Without a pose now and then: are the cameras exchanged? It takes as long as an update, so the light is dark before.
void Session::name_lost_pose(Update& update) {
    constexpr int kEvery = 10;
    if (update.pose.rig_from_patient)
        lost_poses_ = 0;
    else if (lost_poses_++ % kEvery == 0)
        exchanged_ = cameras_seem_exchanged(tracker_, update.frame);
    if (lost_poses_ > 0 && exchanged_)
        update.overlay.reason = update.pose.reason =
            "left and right camera are exchanged: connect them as they were calibrated";
}

/// Darkness that a person asked for is called that, whatever else is wrong.
void Session::name_hidden_plan(Update& update) const {
    if (!update.overlay.lit && !lit_landmark_ && all_hidden())
        update.overlay.reason = "every item of the plan is hidden";
    if (!update.overlay.lit && lit_landmark_ && update.overlay.reason == kNothingInTheLight)
        update.overlay.reason =
            "the landmark is not in the projector's light: turn the head back, or press Stop, then Track";
}

void Session::note_shown(const OverlayStep& overlay) {
    constexpr std::size_t kKept = 12;
    if (!overlay.lit) {
        lit_since_ = Instant::max();
        shown_.clear();
        counts_shown_ = {};
        return;
    }
    if (lit_since_ == Instant::max()) lit_since_ = overlay.lit_from + found_delay_;
    counts_shown_ = overlay.counts;
    shown_.push_back({overlay.lit_from + found_delay_, overlay.rig_from_ct});
    if (shown_.size() > kKept) shown_.erase(shown_.begin());
}

/// What this frame told, and what is wrong with the light by it and those before.
void Session::watch_light(Update& update) {
    LightFacts facts;
    facts.at = update.frame.at;
    facts.pose = update.pose.rig_from_patient.has_value();
    if (facts.pose) facts.rig_from_ct = *update.pose.rig_from_patient * registration_->patient_from_ct;
    if (update.light) {
        facts.segments = update.light->segments;
        facts.expected = update.light->expected;
        facts.seen = update.light->seen;
        facts.far_mm = update.light->far_mm;
        facts.background = update.light->background;
    }
    facts.shown = shown_;
    if (!tracker_.markers().empty()) {
        const Eigen::Vector3d at_scan = tracker_.markers().front().centre_in_patient;
        facts.jump_mm =
            jumps_->add(tracker_.seen_left(), tracker_.seen_right(), (rig_.left_camera.device_from_rig * at_scan).z());
    }
    if (facts.pose && !tracker_.doubts().empty()) {
        facts.slipped_marker = tracker_.doubts().front().marker;
        facts.slipped_mm = tracker_.doubts().front().deviation_mm;
    }
    update.causes = watch_->add(std::move(facts));
}

/// A late picture is drawn ahead, within limits; what was seen before is of the light as it was.
void Session::correct_delay(std::vector<LightCause>& causes) {
    if (causes.empty() || causes.front().fault != LightFault::late_picture) return;
    const Instant more = from_seconds(causes.front().size / 1e3);
    if (found_delay_ + more > settings_.most_delay_corrected || overlay_->light_delay() + more < Instant{}) return;
    causes.front().drawn_ahead = more <= overlay_->spare_time();
    found_delay_ += more;
    overlay_->set_found_delay(found_delay_);
    watch_->forget();
    shown_.clear();
}

/// CHECK: the frame was exposed under the light of the updates before; was there light for all of the exposure?
std::optional<LightCheck> Session::look_at_light(const Update& update) {
    if (settings_.check_light_every <= 0 || ++updates_ % settings_.check_light_every != 0) return std::nullopt;
    const Instant half = update.frame.exposure / 2;
    if (!update.pose.rig_from_patient || update.frame.at - half < lit_since_) return std::nullopt;
    LightCheck check = checker_->look(*update.pose.rig_from_patient * registration_->patient_from_ct, update.frame);
    note_lit_items(counts_shown_, check);
    return check;
}

}  // namespace planlight
