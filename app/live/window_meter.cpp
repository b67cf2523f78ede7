#include "app/live/window_meter.h"

#include <fmt/format.h>
#include <time.h>

#include <algorithm>

namespace planlight {
namespace {

double process_cpu_s() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

double rest_after(std::chrono::steady_clock::duration frame) {
    return std::clamp(0.04 - std::chrono::duration<double>(frame).count(), 0.005, 0.03);
}

void WindowMeter::note(Phase phase, std::size_t frames_drawn) {
    const auto now = std::chrono::steady_clock::now();
    const double cpu_s = process_cpu_s();
    // What lies between two phases belongs to neither: the change itself is drawn there.
    Sum& sum = phase != phase_             ? other_
               : phase == Phase::idle      ? idle_
               : phase == Phase::following ? following_
                                           : other_;
    if (at_ != std::chrono::steady_clock::time_point{}) {
        sum.wall_s += std::chrono::duration<double>(now - at_).count();
        sum.cpu_s += cpu_s - cpu_s_;
        sum.frames += frames_drawn - frames_;
    }
    phase_ = phase;
    at_ = now;
    cpu_s_ = cpu_s;
    frames_ = frames_drawn;
}

double WindowMeter::idle_cpu_percent() const {
    return idle_.wall_s > 0 ? 100 * idle_.cpu_s / idle_.wall_s : 0;
}

double WindowMeter::frames_per_s_following() const {
    return following_.wall_s > 0 ? static_cast<double>(following_.frames) / following_.wall_s : 0;
}

std::string WindowMeter::json() const {
    return fmt::format(
        R"({{"idle_s": {:.1f}, "idle_cpu_percent": {:.2f}, "idle_frames": {}, "following_s": {:.1f}, "frames_per_s": {:.1f}}})",
        idle_.wall_s, idle_cpu_percent(), idle_.frames, following_.wall_s, frames_per_s_following());
}

std::string WindowMeter::sentence() const {
    if (idle_.wall_s < 1 && following_.wall_s < 1) return {};
    return fmt::format(
        "The window: {:.1f} % of a core and {} frames in {:.0f} s of waiting for a person; {:.1f} frames/s in {:.0f} s "
        "of "
        "following the patient",
        idle_cpu_percent(), idle_.frames, idle_.wall_s, frames_per_s_following(), following_.wall_s);
}

}  // namespace planlight
