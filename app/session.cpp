#include "app/session.h"

#include <fmt/format.h>

#include <algorithm>

#include "app/belonging.h"
#include "app/verify_landmarks.h"
#include "planning_io/types/error.h"
#include "projection/skin_now.h"
#include "registration/scan/decode/merge_exposures.h"
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
    if (scanned_->clean.kept.empty()) refuse_scan_without_skin();
    forget_last_light();  // stripes took its place
    capture_ = std::move(exposures.front());
    take_rig(*capture_);
}

void Session::refuse_scan_without_skin() {
    const DecodedView& left = scanned_->left;
    const bool saturated = left.saturated > left.decoded + left.uncertain;
    scanned_.reset();
    if (saturated)
        throw CheckFailedError("the cameras' pictures are too bright for the stripes to be read",
                               "Shorten the cameras' exposure, or turn lamps and projector down, and scan again.");
    throw CheckFailedError("the cameras see none of the stripes on the skin",
                           "See that the projector is on and lights the patient, that its lens is free, and that its "
                           "picture is not frozen (Freeze on its remote control); then scan again.");
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
    ++references_;
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
    now_ = std::make_shared<const CaseDrawing>(case_, planned_, registration_->skin, drawing);
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
    bright_item_ = lit_landmark_ ? lit_landmark_ : item_of_moment_;
    const bool others_lit = !lit_landmark_ && settings_.overlay.render.others > 0;
    looked_for_ = std::make_shared<const PlanDrawing>(bright_item_ ? lit_with(lit_drawing(), *bright_item_, others_lit)
                                                                   : lit_drawing());
    lit_grey_ = 0;
    checker_.emplace(*looked_for_, skin_of_light(), rig_, settings_.check_light, bright_item_);
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

}  // namespace planlight
