#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace planlight {

/// How long a window's loop rests after a frame that took so long, s: some twenty-five frames a second, no longer than
/// 30 ms, and never without a pause for the rest of the program.
double rest_after(std::chrono::steady_clock::duration frame);

/// What an operator window costs: the processor while a person is waited for, the frames while light is asked for.
class WindowMeter {
public:
    enum class Phase { idle, following, other };

    /// After every look at the session: what it was at, and how often the window was drawn so far.
    void note(Phase phase, std::size_t frames_drawn);

    double idle_s() const { return idle_.wall_s; }
    double following_s() const { return following_.wall_s; }
    /// Of one core, of this process: all its threads, those of software OpenGL and of the cameras included.
    double idle_cpu_percent() const;
    double frames_per_s_following() const;

    std::string json() const;      ///< an object: idle_s, idle_cpu_percent, idle_frames, following_s, frames_per_s
    std::string sentence() const;  ///< empty where nothing was measured

private:
    struct Sum {
        double wall_s = 0, cpu_s = 0;
        std::size_t frames = 0;
    };
    Sum idle_, following_, other_;
    Phase phase_ = Phase::other;
    std::chrono::steady_clock::time_point at_{};
    double cpu_s_ = 0;
    std::size_t frames_ = 0;
};

}  // namespace planlight
