#include "app/doctor/running_examination.h"

#include <exception>
#include <optional>

#include "app/doctor/light_until_ended.h"

namespace planlight {

RunningExamination::RunningExamination(const RoomFile& room, ExamineSettings settings)
    : thread_(
          [this, &room, settings = std::move(settings)](const std::stop_token& stop) { run(room, settings, stop); }) {}

void RunningExamination::run(const RoomFile& room, ExamineSettings settings, const std::stop_token& stop) {
    settings.ended = stop;
    settings.under_way = [this](const std::string& step) {
        const std::lock_guard lock(mutex_);
        state_.under_way = step;
    };
    settings.found = [this](const DoctorLine& line) {
        const std::lock_guard lock(mutex_);
        state_.lines.push_back(line);
    };
    settings.ask_window_system = [&](const std::function<void()>& question) { ask(question, stop); };
    try {
        examine_room(room, settings);
    } catch (const std::exception& error) {  // one that no step foresaw; what was found before it stays
        settings.found(line_of_failure("computer", error));
    }
    const std::lock_guard lock(mutex_);
    state_.under_way.clear();
    state_.over = true;
    state_.ended_by_hand = stop.stop_requested();
    state_.took_s = seconds(clock_.now() - began_);
}

void RunningExamination::ask(const std::function<void()>& question, const std::stop_token& stop) {
    std::packaged_task<void()> task(question);
    std::future<void> answer = task.get_future();
    std::unique_lock lock(mutex_);
    question_ = std::move(task);
    if (!answered_.wait(lock, stop, [this] { return !question_; })) {
        question_.reset();
        throw ExaminationEnded();
    }
    lock.unlock();
    answer.get();
}

void RunningExamination::answer() {
    const std::lock_guard lock(mutex_);
    if (!question_) return;
    (*question_)();
    question_.reset();
    answered_.notify_all();
}

ExaminationState RunningExamination::state() const {
    const std::lock_guard lock(mutex_);
    ExaminationState state = state_;
    if (!state.over) state.took_s = seconds(clock_.now() - began_);
    return state;
}

void RunningExamination::end() {
    const std::lock_guard lock(mutex_);
    if (!state_.over) thread_.request_stop();
}

}  // namespace planlight
