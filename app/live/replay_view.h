#pragma once

#include <atomic>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "app/live/live_view.h"
#include "app/live/session_states.h"
#include "app/session_observer.h"
#include "planning_io/types/steady_clock.h"

namespace planlight {

/// How fast a recorded session goes by.
struct ReplayPace {
    double speed = 1;            ///< of the recorded clock
    double longest_pause_s = 1;  ///< of that clock, in which nothing was seen; of a longer one no more is shown
};

/// What a replayed session does, as the operator's window showed it: watches a `replay_session` in its thread, and
/// gives the window's thread a model. The case and its drawing outlive it.
class ReplayView final : public SessionObserver {
public:
    static constexpr const char* kNothingIsProjected = "Replay of a recording: nothing is projected.";

    ReplayView(const Case& the_case, const CaseDrawing& drawing, const ReplayPace& pace = {});

    OperatorModel model() const;
    /// The window was closed: nothing is waited for any more.
    void close() { closed_ = true; }
    bool closed() const { return closed_; }
    void over(const std::string& headline, StatusKind kind);

    void room_entered(const RoomFacts& room) noexcept override;
    void asked(SessionCall call, const std::vector<PointPair>& landmarks, int which) noexcept override;
    /// A session's thread waits for its frames; so does its replay.
    void frame_taken(const StereoFrame& frame) noexcept override;
    void stopped(const Error& why) noexcept override;
    void scanned(const Session& session) noexcept override;
    void matched(const Session& session) noexcept override;
    void resumed(const Session& session, const ResumeCheck& check) noexcept override;
    void updated(const Session& session, const Session::Update& update) noexcept override;
    void refused(SessionCall call, const std::exception& why) noexcept override;
    void gate(GateCall call, Instant at, double off_mm, const LightGate::Ruling* ruling) noexcept override;

private:
    template <class Change>
    void change(const Change& make) noexcept;
    void enter_state(SessionState state) noexcept;
    void goes_out(Status why, SessionState next) noexcept;
    void go_dark() noexcept;
    void show_lit(const Session& session);
    void show_match_of(const Session& session, bool of_this_scan) noexcept;
    void wait_until(Instant at);

    const Case& case_;
    const SkinSurface& skin_;
    const ReplayPace pace_;
    const SteadyClock wall_;
    LiveView view_{wall_};
    const OperatorModel blank_;
    mutable std::mutex mutex_;
    OperatorModel model_;
    std::atomic<bool> closed_{false};
    // From here on of the replay's thread.
    SessionState state_ = SessionState::opening, before_looking_ = SessionState::opening;
    bool following_ = false;
    bool ended_by_dark_ = false;          ///< what was asked for; the darkness that comes says that it was pressed
    std::optional<Status> why_dark_;      ///< of the darkness that comes next
    SessionState then_{};                 ///< where that leads to
    int landmark_ = -1;                   ///< that is lit; -1: the plan is
    int shown_landmark_ = -1;             ///< the landmark, and
    std::set<std::size_t> shown_hidden_;  ///< the hidden items, that the 3-D view was made for
    std::string dark_reason_;
    double delay_ms_ = 0;
    std::optional<Instant> last_at_;
    Instant due_{};
};

}  // namespace planlight
