#include "app/live/shown_replay.h"

#include <fmt/format.h>

#include <atomic>
#include <future>
#include <mutex>
#include <thread>

#include "app/case_model.h"
#include "app/live/live_view.h"
#include "app/live/scene_of_session.h"
#include "app/live/session_states.h"
#include "app/session_observer.h"
#include "app/windows/operator_window.h"
#include "planning_io/files/image_file.h"
#include "planning_io/types/steady_clock.h"

namespace planlight {
namespace {

using namespace std::chrono_literals;

constexpr const char* kNothingIsProjected = "Replay of a recording: nothing is projected.";

/// Thrown out of a replay whose window was closed.
struct WindowClosed {};

/// What the replayed session does, as the window shows it; told of it in the replay's thread.
class ReplayView final : public SessionObserver {
public:
    ReplayView(const Case& the_case, const CaseDrawing& drawing, const ShownReplaySettings& settings)
        : case_(the_case), settings_(settings), blank_(model_of_case(the_case, drawing)), model_(blank_) {
        view_.expect_found(false);
        model_.case_title = "REPLAY \u00b7 " + blank_.case_title;
        enter_state(SessionState::opening);
    }

    OperatorModel model() const {
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
    void close() { closed_ = true; }
    bool closed() const { return closed_; }
    void over(const std::string& headline, StatusKind kind) {
        change([&](OperatorModel& m) { m.status = {kind, headline, {}, {}}; });
    }

    void room_entered(const RoomFacts& room) noexcept override {
        change([&](OperatorModel& m) {
            m.simulated = room.simulated;
            m.case_subtitle = room.name + " \u00b7 " + m.case_subtitle;
        });
        enter_state(SessionState::ready);
    }
    void asked(SessionCall call, const std::vector<PointPair>&, int which) noexcept override {
        const bool stripes =
            call == SessionCall::scan || call == SessionCall::check_skin || call == SessionCall::resume;
        if (call != SessionCall::update || !following_) view_.expect_found(!stripes);
        if (call == SessionCall::scan) enter_state(SessionState::scanning);
        if (call == SessionCall::find_patient) enter_state(SessionState::matching);
        if (call == SessionCall::check_skin) enter_state(SessionState::checking_skin);
        if (call == SessionCall::resume) enter_state(SessionState::looking_again);
        if (call == SessionCall::update && !following_) enter_state(SessionState::following);
        following_ = call == SessionCall::update || (following_ && call != SessionCall::go_dark && !stripes);
        if (call == SessionCall::light_item) change([&](OperatorModel& m) { m.scene.bright_item = which; });
        if (call == SessionCall::go_dark && state_ == SessionState::following) enter_state(SessionState::found);
    }
    /// A session's thread waits for its frames; so does its replay.
    void frame_taken(const StereoFrame& frame) noexcept override {
        wait_until(frame.at);
        view_.take(frame);
    }
    void scanned(const Session&) noexcept override { enter_state(SessionState::scanned); }
    void matched(const Session& session) noexcept override { show_match_of(session, true); }
    void resumed(const Session& session, const ResumeCheck&) noexcept override { show_match_of(session, false); }
    void updated(const Session& session, const Session::Update& update) noexcept override {
        try {
            view_.found(update.frame.at, found_markers(session.tracker().seen_left()),
                        found_markers(session.tracker().seen_right()));
            dark_reason_ = update.overlay.lit ? "" : update.overlay.reason;
            delay_ms_ = 1000 * seconds(update.overlay.lit_from + session.found_delay() - update.pose.at);
            const auto plan = std::make_shared<PlanDrawing>(session.lit_drawing());
            change([&](OperatorModel& m) {
                if (!m.scene.plan || m.scene.plan->items.size() != plan->items.size() ||
                    m.scene.plan->strokes.size() != plan->strokes.size())
                    m.scene.plan = plan;
                for (std::size_t i = 0; i < m.rows.size(); ++i) m.rows[i].hidden = session.hidden_items().contains(i);
                for (std::size_t i = 0; update.light && i < std::min(m.rows.size(), update.light->items.size()); ++i)
                    m.rows[i].light_off_mm =
                        update.light->items[i].known() ? std::optional(update.light->items[i].off_mm) : std::nullopt;
            });
        } catch (const std::exception&) {  // no memory: the next update is shown
        }
    }
    void gate(GateCall call, Instant, double, const LightGate::Ruling* ruling) noexcept override {
        if (call != GateCall::step || !ruling) return;
        const bool lit = dark_reason_.empty();
        const StatusKind kind = !lit                                   ? StatusKind::dark
                                : ruling->stop                         ? StatusKind::refused
                                : ruling->trust == LightTrust::aligned ? StatusKind::aligned
                                                                       : StatusKind::check;
        change([&](OperatorModel& m) {
            m.status = {kind, lit ? ruling->headline : "Dark: " + dark_reason_ + ".", ruling->details, {}};
            m.figures.overlay_error_mm = ruling->off_mm;
            m.figures.delay_to_light_ms = lit ? std::optional(delay_ms_) : std::nullopt;
        });
    }
    void refused(SessionCall, const std::exception& why) noexcept override {
        following_ = false;
        change([&](OperatorModel& m) { m.status = {StatusKind::refused, std::string(why.what()) + ".", {}, {}}; });
    }

private:
    template <class Change>
    void change(const Change& make) noexcept {
        try {
            const std::lock_guard lock(mutex_);
            make(model_);
        } catch (const std::exception&) {  // no memory: the next one is shown
        }
    }
    void enter_state(SessionState state) noexcept {
        state_ = state;
        change([&](OperatorModel& m) { enter(state, blank_, m); });
    }

    /// What a match looks like, as a session shows it. `scanned`: its scan is this recording's.
    void show_match_of(const Session& session, bool scanned) noexcept {
        const RegistrationResult* found = session.registration();
        if (!found) return;
        enter_state(found->verdict == Verdict::yes   ? SessionState::found
                    : found->verdict == Verdict::ask ? SessionState::unsure
                                                     : SessionState::not_found);
        change([&](OperatorModel& m) {
            const bool cloud = scanned && session.scanned();
            show_match(case_, *found, cloud ? std::make_shared<PointCloud>(session.scanned()->clean.kept) : nullptr, m);
            if (found->verdict == Verdict::no) return;
            m.scene.markers = markers_in_ct(session.tracker(), m.scene.ct_from_rig);
            m.scene.plan = std::make_shared<PlanDrawing>(session.drawing());
            name_rows(session.drawing(), m.rows);
            m.projector_view = projector_view(session.rig(), m.scene.ct_from_rig);
        });
    }

    /// Until it is that late on the recorded clock, as the window runs it.
    void wait_until(Instant at) {
        const Instant now = wall_.now();
        if (!last_at_) {
            due_ = now;
        } else {
            const double gone_s = std::min(settings_.longest_pause_s, std::max(0.0, seconds(at - *last_at_)));
            due_ = std::max(due_ + from_seconds(gone_s / settings_.speed), now - Instant(200ms));
        }
        last_at_ = at;
        while (wall_.now() < due_ && !closed_) std::this_thread::sleep_for(std::min<Instant>(due_ - wall_.now(), 20ms));
    }

    const Case& case_;
    const ShownReplaySettings settings_;
    const SteadyClock wall_;
    LiveView view_{wall_};
    const OperatorModel blank_;
    mutable std::mutex mutex_;
    OperatorModel model_;
    std::atomic<bool> closed_{false};
    SessionState state_ = SessionState::opening;  // from here on of the replay's thread
    bool following_ = false;
    std::string dark_reason_;
    double delay_ms_ = 0;
    std::optional<Instant> last_at_;
    Instant due_{};
};

/// A picture whenever the status changes its kind, a moment after.
class Pictures {
public:
    explicit Pictures(std::filesystem::path folder) : folder_(std::move(folder)) {
        if (!folder_.empty()) std::filesystem::create_directories(folder_);
    }
    void take(OperatorWindow& window, const OperatorModel& model) {
        constexpr int kSettled = 6;
        const auto kind = static_cast<int>(model.status.kind);
        looks_ = kind == kind_ ? looks_ + 1 : 0;
        kind_ = kind;
        if (!folder_.empty() && looks_ == kSettled)
            write_png(window.screenshot(), folder_ / fmt::format("replay-{:02d}.png", ++number_));
    }

private:
    std::filesystem::path folder_;
    int kind_ = -1, looks_ = 0, number_ = 0;
};

/// True: the person has closed it.
bool show_once(OperatorWindow& window, const ReplayView& view, Pictures& pictures) {
    constexpr double kRest_s = 0.03;
    const OperatorModel model = view.model();
    const OperatorAction action = window.frame(model);
    if (action != OperatorAction::none && action != OperatorAction::quit) window.say(kNothingIsProjected);
    pictures.take(window, model);
    window.rest(kRest_s);
    return action == OperatorAction::quit;
}

std::string words_of_end(const ReplayResult& result) {
    if (result.difference) return "The replay is over: it differs from the recording.";
    return result.ended.empty() ? "The replay is over: alike to the last digit."
                                : "The replay is over: alike as far as the recording goes.";
}

}  // namespace

std::optional<ReplayResult> show_replay(const std::filesystem::path& recording, const Case& the_case,
                                        const ShownReplaySettings& settings) {
    WindowSettings window_settings;
    window_settings.words = settings.words;
    OperatorWindow window(window_settings);
    const CaseDrawing drawing(the_case);
    ReplayView view(the_case, drawing, settings);
    const auto go_on = [&](double) {
        if (view.closed()) throw WindowClosed{};
    };
    auto replayed = std::async(std::launch::async, [&] { return replay_session(recording, the_case, go_on, &view); });
    Pictures pictures(settings.screenshots);
    while (replayed.wait_for(0s) != std::future_status::ready)
        if (show_once(window, view, pictures)) view.close();
    try {
        const ReplayResult result = replayed.get();
        view.over(words_of_end(result), result.difference ? StatusKind::check : StatusKind::ready);
        for (int looks = 0; !settings.close_at_end || looks < 12; ++looks)
            if (show_once(window, view, pictures)) break;
        return result;
    } catch (const WindowClosed&) {
        return std::nullopt;
    }
}

}  // namespace planlight
