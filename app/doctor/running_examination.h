#pragma once

#include <condition_variable>
#include <future>
#include <mutex>
#include <optional>
#include <thread>

#include "app/doctor/examine_room.h"
#include "planning_io/types/steady_clock.h"

namespace planlight {

/// How far an examination has come.
struct ExaminationState {
    std::vector<DoctorLine> lines;  ///< as they were found
    std::string under_way;          ///< "the cameras"; empty before the first step and when it is over
    bool over = false;
    bool ended_by_hand = false;  ///< something was not looked at
    double took_s = 0;           ///< so far
};

/// `examine_room` in a thread of its own, for a window that shows each line as it is found. Ended, and the projector
/// dark, when it is destroyed.
///
/// The window system may be asked from the main thread alone: what is to be known of it is asked there.
class RunningExamination {
public:
    /// `room` must outlive it; of the settings only `case_folder` and `watch` are taken.
    RunningExamination(const RoomFile& room, ExamineSettings settings);

    /// Answers what it asks of the window system, so that it goes on. To be called again and again, from the main
    /// thread.
    void answer();
    ExaminationState state() const;
    /// The projector is dark when this returns, and is lit no more; what goes on without light (cameras that are
    /// opened) takes a second or two more. Does nothing when it is over.
    void end();

private:
    void run(const RoomFile& room, ExamineSettings settings, const std::stop_token& stop);
    void ask(const std::function<void()>& question, const std::stop_token& stop);

    SteadyClock clock_;
    const Instant began_ = clock_.now();
    mutable std::mutex mutex_;
    std::condition_variable_any answered_;
    std::optional<std::packaged_task<void()>> question_;
    ExaminationState state_;  ///< `took_s` only when it is over
    std::jthread thread_;
};

}  // namespace planlight
