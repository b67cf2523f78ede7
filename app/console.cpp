#include "app/console.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <exception>
#include <new>
#include <system_error>

#include "planning_io/files/memory_need.h"
#include "planning_io/types/error.h"

namespace planlight {

ProgressBar::ProgressBar() : terminal_(isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() {
    end_line();
}

void ProgressBar::show(const std::string& step, double share) {
    if (!terminal_) return;
    if (step != step_) end_line();
    const int percent = static_cast<int>(100 * std::clamp(share, 0.0, 1.0));
    if (step == step_ && percent == percent_) return;
    step_ = step;
    percent_ = percent;
    constexpr int kWidth = 40;
    const int done = kWidth * percent / 100;
    fmt::print(stderr, "\r{:<18} [{}{}] {:3d} %", step, std::string(static_cast<std::size_t>(done), '#'),
               std::string(static_cast<std::size_t>(kWidth - done), ' '), percent);
    std::fflush(stderr);
}

void ProgressBar::end_line() {
    if (terminal_ && !step_.empty()) fmt::print(stderr, "\n");
    step_.clear();
    percent_ = -1;
}

std::function<void(const std::string&, double)> ProgressBar::callback() {
    return [this](const std::string& step, double share) { show(step, share); };
}

void ProgressBar::note(const std::string& line) {
    end_line();
    fmt::print(stderr, "{}\n", line);
}

void warn(const std::string& text) {
    fmt::print(stderr, "warning: {}\n", text);
}

std::string today() {
    const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
    std::tm utc{};
    gmtime_r(&now, &utc);
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
    return text;
}

namespace {

int explain_short_memory() {
    fmt::print(
        stderr,
        "planlight: there is not enough memory: this needs more than the {} MiB that it had. Close other programs, or "
        "use larger voxels.\n",
        most_memory_used_bytes() >> 20);
    return static_cast<int>(ExitCode::disk);
}

}  // namespace

int run_and_explain(const std::function<int()>& command) {
    try {
        return command();
    } catch (const Error& error) {
        fmt::print(stderr, "planlight: {}. {}\n", error.what(), error.remedy);
        return static_cast<int>(error.exit_code);
    } catch (const std::bad_alloc&) {
        return explain_short_memory();
    } catch (const std::system_error& fault) {  // a thread that finds no room
        if (fault.code() == std::errc::resource_unavailable_try_again || fault.code() == std::errc::not_enough_memory)
            return explain_short_memory();
        fmt::print(stderr, "planlight: a fault of ours: {}. Please report it with the command that you gave.\n",
                   fault.what());
    } catch (const std::exception& fault) {
        fmt::print(stderr, "planlight: a fault of ours: {}. Please report it with the command that you gave.\n",
                   fault.what());
    }
    return static_cast<int>(ExitCode::our_fault);
}

}  // namespace planlight
