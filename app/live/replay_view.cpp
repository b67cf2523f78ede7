#include "app/live/replay_view.h"

#include <algorithm>
#include <thread>
#include <utility>

#include "app/case_model.h"
#include "app/live/following_status.h"
#include "app/live/scene_of_session.h"
#include "planning_io/types/error.h"

namespace planlight {

using namespace std::chrono_literals;

template <class Change>
void ReplayView::change(const Change& make) noexcept {
    try {
        const std::lock_guard lock(mutex_);
        make(model_);
    } catch (const std::exception&) {  // no memory: the next one is shown
    }
}

ReplayView::ReplayView(const Case& the_case, const CaseDrawing& drawing, const ReplayPace& pace)
    : case_(the_case), skin_(drawing.skin), pace_(pace), blank_(model_of_case(the_case, drawing)), model_(blank_) {
    view_.expect_found(false);
    model_.case_title = "REPLAY \u00b7 " + blank_.case_title;
    enter_state(SessionState::opening);
}

OperatorModel ReplayView::model() const {
    OperatorModel shown;
    {
        const std::lock_guard lock(mutex_);
        shown = model_;
    }
    view_.put_into(shown);
    for (ButtonState* button : {&shown.scan, &shown.do_register, &shown.track, &shown.stop})
        *button = {false, "a replay"};
    shown.check_skin = shown.confirm = shown.may_light_item = shown.light_on = false;
    shown.next = OperatorAction::none;
    shown.landmarks.reset();
    shown.status.details.insert(shown.status.details.begin(), kNothingIsProjected);
    return shown;
}

void ReplayView::over(const std::string& headline, StatusKind kind) {
    change([&](OperatorModel& m) { m.status = {kind, headline, {}, {}}; });
}

void ReplayView::enter_state(SessionState state) noexcept {
    state_ = state;
    change([&](OperatorModel& m) { enter(state, blank_, m); });
}

void ReplayView::room_entered(const RoomFacts& room) noexcept {
    change([&](OperatorModel& m) {
        m.room_kind = room.kind;
        m.case_subtitle += " \u00b7 " + room.name;
    });
    enter_state(SessionState::ready);
}

void ReplayView::asked(SessionCall call, const std::vector<PointPair>&, int which) noexcept {
    if (call == SessionCall::go_dark) return go_dark();
    if (call == SessionCall::light_landmark) landmark_ = which;
    const bool stripes = call == SessionCall::scan || call == SessionCall::check_skin || call == SessionCall::resume;
    if (call != SessionCall::update || !following_) view_.expect_found(!stripes);
    if (call == SessionCall::resume) before_looking_ = view_of(state_).has_match ? SessionState::found : state_;
    if (call == SessionCall::scan) enter_state(SessionState::scanning);
    if (call == SessionCall::find_patient) enter_state(SessionState::matching);
    if (call == SessionCall::check_skin) enter_state(SessionState::checking_skin);
    if (call == SessionCall::resume) enter_state(SessionState::looking_again);
    if (call == SessionCall::update && !following_) enter_state(SessionState::following);
    following_ = call == SessionCall::update || (following_ && !stripes);
}

/// It goes out with the next darkness, for that reason.
void ReplayView::goes_out(Status why, SessionState next) noexcept {
    change([&](OperatorModel& m) { m.status = why; });
    why_dark_ = std::move(why);
    then_ = next;
}

/// For the reason that was told before; else DARK was pressed.
void ReplayView::go_dark() noexcept {
    const SessionState next = why_dark_ ? then_ : after_press(state_, OperatorAction::dark).value_or(state_);
    following_ = next == SessionState::following;  // what was lost comes back by itself
    ended_by_dark_ = false;
    view_.expect_found(true);
    enter_state(next);
    change([&](OperatorModel& m) { m.status = why_dark_ ? *why_dark_ : dark_status(next); });
    why_dark_.reset();
}

void ReplayView::frame_taken(const StereoFrame& frame) noexcept {
    wait_until(frame.at);
    view_.take(frame);
}

void ReplayView::stopped(const Error&) noexcept {
    ended_by_dark_ = true;
}

void ReplayView::scanned(const Session&) noexcept {
    enter_state(SessionState::scanned);
}

void ReplayView::matched(const Session& session) noexcept {
    show_match_of(session, true);
}

void ReplayView::resumed(const Session& session, const ResumeCheck&) noexcept {
    show_match_of(session, false);
}

/// What of the plan is lit, in the table and in the 3-D view.
void ReplayView::show_lit(const Session& session) {
    const std::set<std::size_t>& hidden = session.hidden_items();
    const bool other = landmark_ != shown_landmark_ || hidden != shown_hidden_;
    const auto plan = other ? std::make_shared<PlanDrawing>(session.lit_drawing()) : nullptr;
    shown_landmark_ = landmark_, shown_hidden_ = hidden;
    change([&](OperatorModel& m) {
        if (plan) m.scene.plan = plan;
        m.item_of_moment = session.item_of_moment();
        m.scene.bright_item = landmark_ >= 0 ? landmark_ : m.item_of_moment ? static_cast<int>(*m.item_of_moment) : -1;
        for (std::size_t i = 0; i < m.rows.size(); ++i) m.rows[i].hidden = hidden.contains(i);
    });
}

void ReplayView::updated(const Session& session, const Session::Update& update) noexcept {
    try {
        view_.found(update.frame.at, found_markers(session.tracker().seen_left()),
                    found_markers(session.tracker().seen_right()));
        dark_reason_ = update.overlay.lit ? "" : update.overlay.reason;
        delay_ms_ = 1000 * seconds(update.overlay.lit_from + session.found_delay() - update.pose.at);
        show_lit(session);
        change([&](OperatorModel& m) {
            for (std::size_t i = 0; update.light && i < std::min(m.rows.size(), update.light->items.size()); ++i)
                m.rows[i].light_off_mm = item_off_mm(*update.light, i);
        });
    } catch (const std::exception&) {  // no memory: the next update is shown
    }
}

void ReplayView::gate(GateCall call, Instant, double, const LightGate::Ruling* ruling) noexcept {
    if (!ruling || (call != GateCall::step && call != GateCall::forbids)) return;
    try {
        if (ruling->stop)
            return goes_out({StatusKind::refused, ruling->headline, ruling->details, {}}, SessionState::found);
        const bool lit = dark_reason_.empty();
        const StatusKind kind = !lit                                   ? StatusKind::dark
                                : ruling->trust == LightTrust::aligned ? StatusKind::aligned
                                                                       : StatusKind::check;
        change([&](OperatorModel& m) {
            m.status = {kind, lit ? ruling->headline : "Dark: " + dark_reason_ + ".", ruling->details, {}};
            m.figures.overlay_error_mm = ruling->of_other ? std::nullopt : ruling->off_mm;
            m.figures.delay_to_light_ms = lit ? std::optional(delay_ms_) : std::nullopt;
        });
    } catch (const std::exception&) {  // no memory: the next ruling is shown
    }
}

/// What DARK ended says nothing more; a device that was lost while the light followed comes back by itself.
void ReplayView::refused(SessionCall call, const std::exception& why) noexcept {
    try {
        const SessionState next =
            state_ == SessionState::looking_again ? before_looking_ : after(state_, SessionHappening::failed);
        if (ended_by_dark_) return goes_out(dark_status(next), next);
        const auto* said = dynamic_cast<const Error*>(&why);
        const std::vector<std::string> details = said ? std::vector{said->remedy} : std::vector<std::string>{};
        if (!dynamic_cast<const DeviceError*>(&why))
            return goes_out({StatusKind::refused, std::string(why.what()) + ".", details, {}}, next);
        const bool comes_back = call == SessionCall::update || call == SessionCall::check_skin;
        goes_out({StatusKind::dark, std::string("Dark: ") + why.what() + ".", details, {}},
                 comes_back ? SessionState::following : next);
    } catch (const std::exception&) {  // no memory: it is dark without a word
    }
}

/// What a match looks like, as a session shows it. `of_this_scan`: its scan is this recording's.
void ReplayView::show_match_of(const Session& session, bool of_this_scan) noexcept {
    const RegistrationResult* found = session.registration();
    if (!found) return;
    landmark_ = -1;
    enter_state(found->verdict == Verdict::yes   ? SessionState::found
                : found->verdict == Verdict::ask ? SessionState::unsure
                                                 : SessionState::not_found);
    change([&](OperatorModel& m) {
        const bool cloud = of_this_scan && session.scanned();
        show_match(case_, *found, cloud ? std::make_shared<PointCloud>(session.scanned()->clean.kept) : nullptr, m);
        if (found->verdict == Verdict::no) return;
        m.scene.markers = markers_in_ct(session.tracker(), m.scene.ct_from_rig, skin_);
        name_rows(session.drawing(), m.rows);
        m.projector_view = projector_view(session.rig(), m.scene.ct_from_rig);
    });
    shown_landmark_ = -2;  // of no drawing yet
    if (found->verdict != Verdict::no) show_lit(session);
}

/// Until it is that late on the recorded clock, as the window runs it.
void ReplayView::wait_until(Instant at) {
    const Instant now = wall_.now();
    if (!last_at_) {
        due_ = now;
    } else {
        const double gone_s = std::min(pace_.longest_pause_s, std::max(0.0, seconds(at - *last_at_)));
        due_ = std::max(due_ + from_seconds(gone_s / pace_.speed), now - Instant(200ms));
    }
    last_at_ = at;
    while (wall_.now() < due_ && !closed_) std::this_thread::sleep_for(std::min<Instant>(due_ - wall_.now(), 20ms));
}

}  // namespace planlight
