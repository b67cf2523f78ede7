// One frame of a session: pose, light, and what the frame shows of the light before it.
#include <algorithm>

#include "app/session.h"
#include "planning_io/types/error.h"
#include "registration/tracking/exchanged_cameras.h"

namespace planlight {
namespace {

double elapsed_s(std::chrono::steady_clock::time_point since) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - since).count();
}

}  // namespace

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
    if (update.light) {
        overlay_->set_brightness(brightness_.look(*update.light));
        if (update.light->seen > 0) lit_grey_ = light_grey(*update.light);
        note_seen(*update.light, update.frame.at);
    }
    watch_light(update);
    update.times.check_s = elapsed_s(checking_began);
    note_shown(update.overlay);
    update.light_stays =
        sees_last_light(update.frame, !update.overlay.lit, [&] { return update.pose.rig_from_patient; });
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
    note_lit(overlay);
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
