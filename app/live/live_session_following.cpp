// What a live session does with each update while the light follows the patient, and what it says of it.
#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "app/case_model.h"
#include "app/live/following_status.h"
#include "app/live/live_session.h"
#include "app/live/scene_of_session.h"

namespace planlight {

/// Where it was wished for: announced, which is returned, and then as if it had been pressed.
std::string LiveSession::check_skin_when_due(const Session& session, Room& room, const Session::Update& update) {
    if (!checks_.wished_for()) return {};
    std::vector<Eigen::Vector3d> markers;
    if (update.pose.rig_from_patient)
        for (const auto& marker : session.tracker().markers())
            markers.push_back(*update.pose.rig_from_patient * marker.centre_in_patient);
    const bool lit = update.overlay.lit && gate_.verified() && landmark_ < 0;
    const SkinCheckSchedule::Turn turn = checks_.step(seen_at_, gate_.skin_known_at().value_or(seen_at_), lit, markers);
    room.let_patient_move(turn.notice.empty());  // asked to lie still
    if (turn.check) post(OperatorAction::check_skin, AskedBy::program, {}, permitted_);
    return turn.notice;
}

void LiveSession::follow(Session& session, Room& room) {
    if (const auto forbidden = gate_.forbids(seen_at_)) {  // a check of the skin, or the match itself, says no
        stop_light(session, *forbidden);
        return;
    }
    const auto update = session.update();
    if (!light_permitted()) return;  // DARK was pressed meanwhile; its own turn comes next
    seen_at_ = update.frame.at;
    say_whether_light_stays(update.light_stays);
    LightGate::Ruling ruling =
        gate_.step(seen_at_, update.overlay.lit, update.light, update.causes, update.pose.external_reliability_mm);
    if (ruling.stop) {
        stop_light(session, ruling);
        return;
    }
    show_verification(update, ruling);
    const std::string notice = check_skin_when_due(session, room, update);
    play_fault(ruling, room);
    projecting_ = update.overlay.lit;
    show_update(session, room, update, ruling, notice);
}

void LiveSession::play_fault(const LightGate::Ruling& ruling, Room& room) {
    constexpr int kGoodBefore = 20;
    if (ruling.trust == LightTrust::aligned && ++good_updates_ == kGoodBefore) room.begin_fault();
}

void LiveSession::stop_light(Session& session, const LightGate::Ruling& ruling) {
    following_ = projecting_ = false;
    session.go_dark();
    if (landmark_ >= 0) end_verification(session);
    happened(SessionHappening::failed, [&](OperatorModel& m) {  // what was seen then stays to be looked at
        OperatorModel seen;
        view_.put_into(seen);
        m.left.refused = seen.left.live;
        m.right.refused = seen.right.live;
        m.steps[4] = StepState::attention;
        m.next = OperatorAction::scan;  // as is said; Track is there for who knows better
        m.status = {StatusKind::refused, ruling.headline, ruling.details};
    });
}

/// How many pictures reached the skin in the last two seconds of the room, a second; empty while there were too few to
/// say.
std::optional<double> LiveSession::lit_per_s(const Session::Update& update) {
    constexpr Instant kOver = std::chrono::seconds(2);
    if (!update.overlay.lit) {
        lit_at_.clear();
        return std::nullopt;
    }
    lit_at_.push_back(update.overlay.lit_from);
    while (lit_at_.back() - lit_at_.front() > kOver) lit_at_.pop_front();
    if (lit_at_.size() < 5) return std::nullopt;
    return static_cast<double>(lit_at_.size() - 1) / seconds(lit_at_.back() - lit_at_.front());
}

/// Under the lock of the model: every update is counted, and said now and then as the last of the evidence.
void LiveSession::note_latency(const Session::Update& update, OperatorModel& m) {
    constexpr std::size_t kEvery = 25;
    const std::string before = latency_words_;
    latency_.add(update);
    if (latency_.updates % kEvery != 0) return;
    latency_words_ = latency_.sentence();
    if (latency_words_.empty()) return;
    if (!before.empty() && !m.evidence.empty() && m.evidence.back() == before)
        m.evidence.back() = latency_words_;
    else
        m.evidence.push_back(latency_words_);
}

/// A landmark that has only just been lit cannot have been looked at: a press that bounces says nothing.
bool LiveSession::looked_at(Instant now) const {
    constexpr Instant kLeast = std::chrono::milliseconds(500);
    return landmark_ < 0 || (landmark_lit_from_ && now - *landmark_lit_from_ >= kLeast);
}

/// Beside each item how far its light was seen off; nothing while the plan is not lit.
void LiveSession::show_measured(const Session::Update& update, OperatorModel& m) const {
    const bool plan_lit = update.overlay.lit && landmark_ < 0;
    for (std::size_t i = 0; i < m.rows.size(); ++i) {
        if (!plan_lit) m.rows[i].light_off_mm.reset();
        if (!plan_lit || !update.light || i >= update.light->items.size()) continue;
        m.rows[i].light_off_mm = item_off_mm(*update.light, i);
    }
}

void LiveSession::show_update(const Session& session, const Room& room, const Session::Update& update,
                              const LightGate::Ruling& ruling, const std::string& notice) {
    const auto light = room.true_light(session.lit_drawing(), update.overlay);
    Figures figures;
    figures.updates_per_s = lit_per_s(update);
    figures.delay_to_light_ms = 1000 * seconds(update.overlay.lit_from + session.found_delay() - update.pose.at);
    if (update.pose.rig_from_patient) {
        const Eigen::Vector3d middle = session.tracker().markers().front().centre_in_patient;
        figures.head_moved_mm = (*update.pose.rig_from_patient * middle - middle).norm();
        figures.head_turned_deg =
            angle_between(*update.pose.rig_from_patient, RigidTransform::Identity()) * 180 / std::numbers::pi;
    }
    if (!update.overlay.lit) figures.delay_to_light_ms.reset();
    // Not that of a landmark, nor beside the figure of something else.
    if (landmark_ < 0 && !ruling.of_other) figures.overlay_error_mm = ruling.off_mm;
    view_.found(update.frame.at, found_markers(session.tracker().seen_left()),
                found_markers(session.tracker().seen_right()));
    Status status = status_of(session, update, ruling, !drawing_.settings.card.empty() && landmark_ < 0);
    if (!notice.empty()) status.details.insert(status.details.begin(), notice);
    bool told = false;
    change_model([&](OperatorModel& m) {
        note_latency(update, m);
        // DARK or something else was pressed meanwhile, and stands there already.
        if (permitted_ != darks_ || (state_ != SessionState::following && state_ != SessionState::verifying)) return;
        told = true;
        m.status = status;
        m.steps[4] = gate_.verified() ? StepState::done : StepState::attention;
        m.steps[5] = gate_.verified() ? StepState::active : StepState::waiting;
        // A yes that waits for its turn is not asked for twice: the second would be of what has not been lit yet.
        const bool said_yes = std::any_of(presses_.begin(), presses_.end(),
                                          [](const Press& press) { return press.action == OperatorAction::confirm; });
        m.confirm = update.overlay.lit && ruling.ask_to_verify && !said_yes && looked_at(update.frame.at);
        m.next = m.confirm ? OperatorAction::confirm : OperatorAction::none;
        m.confirm_words = landmark_ >= 0 ? fmt::format("Light {} is right", landmark_ + 1) : "Show landmarks";
        show_measured(update, m);
        m.figures = figures;
        m.scene.light = light;
        if (update.overlay.lit) m.projector_view = projector_view(session.rig(), update.overlay.rig_from_ct.inverse());
    });
    if (told) said();
}

/// What is said while a landmark is lit, where nothing worse is to be said.
void LiveSession::show_verification(const Session::Update& update, LightGate::Ruling& ruling) {
    if (!update.overlay.lit) landmark_lit_from_.reset();
    if (landmark_ < 0 && !cannot_verify_.empty() && update.overlay.lit && !ruling.stop)
        ruling.details.insert(ruling.details.begin(), cannot_verify_);
    if (landmark_ < 0 || !update.overlay.lit || ruling.stop) return;
    if (!landmark_lit_from_) landmark_lit_from_ = update.overlay.lit_from;
    std::erase_if(ruling.details, [](const std::string& detail) {  // that has been done
        return detail.find("\"Show landmarks\"") != std::string::npos;
    });
    const std::string question =
        fmt::format("LOOK: is the ring of light on landmark {} of {}?", landmark_ + 1, landmarks_to_look_at_);
    if (ruling.found_wrong)
        ruling.details.insert(ruling.details.begin(), question);
    else
        ruling.headline = question;
    ruling.details.insert(
        ruling.details.begin() + (ruling.found_wrong ? 1 : 0),
        (landmark_place_.empty() ? "The picture of the head shows where it belongs."
                                 : "It belongs there: " + landmark_place_ + " (see the picture of the head).") +
            " If it lies elsewhere on the patient, press Stop, and scan again.");
}

}  // namespace planlight
