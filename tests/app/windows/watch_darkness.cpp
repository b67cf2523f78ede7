// How long a light outlives the program that holds it, in the pixels of the monitor. Run by two_monitors.sh on an X
// server with two monitors: `watch_darkness FOLDER`, with PLANLIGHT the program (for its projector process) and ROUNDS
// how often each fault is tried (default 3), of which FROM_FAULT leaves the first ones out (0: none). The same
// executable, as `watch_darkness hold MONITOR`, is the program that is stopped, killed, or made to hang while its light
// is on. Exit code 0 when every light was dark in 300 ms. With FAULTY_DRIVER, the library of that name, also a graphics
// driver that hangs before a picture expires, while nothing else is ordered: dark in 900 ms, or in 400 ms from the end
// of the program; and one that hangs while pictures come thirty times a second: dark in 650 ms, also where the program
// is stopped; and one that lost its context and draws nothing any more, as a picture expires or between two: dark in
// 300 ms.
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <random>
#include <span>
#include <thread>
#include <vector>

#include "desktop_picture.h"
#include "planning_io/types/error.h"
#include "projection/monitor/projector_process.h"
#include "projection/monitor/projector_window.h"
#include "root_window.h"
#include "screen_pixel.h"

namespace {

using namespace planlight;
using test::expect;
using namespace std::chrono_literals;

constexpr Instant kLongest = 300ms;

volatile std::sig_atomic_t deadlock = 0, endless_loop = 0;

/// Holds a white light as a session does: checks, renews, sleeps. SIGUSR1 makes it a deadlock, SIGUSR2 a loop without
/// end. The picture expires after EXPIRES_MS, if that is set; with PICTURES_EVERY_MS new ones follow it.
int hold(const std::string& monitor) {
    const char* const expires_ms = std::getenv("EXPIRES_MS");
    std::signal(SIGUSR1, [](int) { deadlock = 1; });
    std::signal(SIGUSR2, [](int) { endless_loop = 1; });
    ProjectorProcessSettings settings;
    settings.program = std::getenv("PLANLIGHT");
    ProjectorProcess projector(monitor, settings);
    projector.renew();
    projector.show(RgbImage(projector.width(), projector.height(), {255, 255, 255}),
                   SteadyClock().now() +
                       (expires_ms == nullptr ? Instant(600s) : std::chrono::milliseconds(std::atoi(expires_ms))));
    fmt::print("{}\n", projector.process());
    std::fflush(stdout);
    const char* const every_ms = std::getenv("PICTURES_EVERY_MS");
    while (every_ms != nullptr) {
        projector.renew();
        projector.show(RgbImage(projector.width(), projector.height(), {255, 255, 255}), SteadyClock().now() + 75ms);
        std::this_thread::sleep_for(std::chrono::milliseconds(std::atoi(every_ms)));
    }
    for (;;) {
        while (deadlock) std::this_thread::sleep_for(1h);
        while (endless_loop) {
        }
        projector.check();
        projector.renew();
        std::this_thread::sleep_for(4ms);
    }
}

struct Holder {
    pid_t program = -1, projector = -1;
    Instant lit_at{};  ///< its program said so

    void end() const {
        kill(program, SIGKILL);
        waitpid(program, nullptr, 0);
        if (projector > 0) kill(projector, SIGKILL);
        std::this_thread::sleep_for(20ms);
    }
};

/// Starts a program that holds light, and waits until it is lit.
Holder start_holder(const char* self, const std::string& monitor) {
    int ends[2];
    if (pipe(ends) != 0) std::abort();
    Holder holder;
    holder.program = fork();
    if (holder.program == 0) {
        setpgid(0, 0);  // as a shell starts a job
        dup2(ends[1], STDOUT_FILENO);
        close(ends[0]);
        close(ends[1]);
        execl(self, self, "hold", monitor.c_str(), nullptr);
        _exit(127);
    }
    close(ends[1]);
    char text[32] = {};
    if (read(ends[0], text, sizeof text - 1) > 0) holder.projector = std::atoi(text);
    close(ends[0]);
    holder.lit_at = SteadyClock().now();
    return holder;
}

/// The same, and that it is seen. Where the machine is so busy that the light has gone before anybody looked, nothing
/// was tried yet: once more.
Holder start_lit_holder(const char* self, const std::string& monitor, const test::ScreenPixel& eye,
                        const std::string& fault) {
    constexpr int kTries = 3;
    for (int i = 0;; ++i) {
        const Holder holder = start_holder(self, monitor);
        if (holder.projector > 0 && eye.lit_soon()) return holder;
        holder.end();
        if (i + 1 == kTries) {
            expect(false, fault + ": there was light before");
            std::exit(1);
        }
    }
}

enum class Hits { program, job, projector };  ///< a job: all that a terminal's Ctrl-Z reaches
struct Fault {
    const char* name;
    int signal;
    Hits hits;

    void strike(const Holder& holder) const {
        kill(hits == Hits::projector ? holder.projector : hits == Hits::job ? -holder.program : holder.program, signal);
    }
};
constexpr Fault kFaults[] = {
    {"the program is stopped (SIGSTOP)", SIGSTOP, Hits::program},
    {"Ctrl-Z in the terminal (SIGTSTP to the job)", SIGTSTP, Hits::job},
    {"the program is killed (SIGKILL)", SIGKILL, Hits::program},
    {"the program deadlocks", SIGUSR1, Hits::program},
    {"the program loops without end", SIGUSR2, Hits::program},
    {"the projector process is stopped", SIGSTOP, Hits::projector},
    {"the projector process is killed", SIGKILL, Hits::projector},
};

void watch(const char* self, const Monitor& monitor, int rounds) {
    const test::ScreenPixel eye(monitor);
    std::minstd_rand random(1);
    std::uniform_int_distribution<int> delay_ms(0, 120);
    const int from = std::getenv("FROM_FAULT") == nullptr ? 0 : std::atoi(std::getenv("FROM_FAULT"));
    for (const Fault& fault : std::span(kFaults).subspan(static_cast<std::size_t>(std::clamp(from, 0, 7)))) {
        std::vector<Instant> times;
        int never = 0;
        for (int round = 0; round < rounds; ++round) {
            const Holder holder = start_lit_holder(self, monitor.name, eye, fault.name);
            std::this_thread::sleep_for(std::chrono::milliseconds(delay_ms(random)));
            fault.strike(holder);
            if (const auto dark = eye.until_dark(5s))
                times.push_back(*dark);
            else
                ++never;
            holder.end();
        }
        std::sort(times.begin(), times.end());
        const auto ms = [&](std::size_t i) { return 1000 * seconds(times.at(i)); };
        if (times.empty()) times.push_back(5s);
        expect(never == 0 && times.back() <= kLongest,
               fmt::format("{}: dark after {:.0f} ms (median), {:.0f} ms (worst of {}), never {} times", fault.name,
                           ms(times.size() / 2), ms(times.size() - 1), rounds, never));
    }
}

/// A graphics driver that fails from a moment on. What is lit then can be taken down by the end of its process alone.
struct DriverFault {
    const char* name;
    const char* kind;             ///< the variable of the faulty driver that names the file
    const char *setting, *value;  ///< what the holder of the light is told
    Instant until_fault;          ///< from the light on
    bool fails_before = false;    ///< the driver fails all that time, and the picture expires at its end
    int signal = 0;               ///< to the program at the fault; 0: none
    Instant longest;
    const char* reads = "READS_NOTHING";  ///< or zeros: what the driver says is in its buffer
};
constexpr const char *kHang = "HANG_WHEN", *kLost = "LOSE_CONTEXT_WHEN";
constexpr const char *kExpiry = "EXPIRES_MS", *kPictures = "PICTURES_EVERY_MS";
constexpr DriverFault kDriverFaults[] = {
    {"the graphics driver hangs as a picture expires", kHang, kExpiry, "600", 600ms, true, 0, 900ms},
    {"the same, and the program is killed", kHang, kExpiry, "600", 600ms, true, SIGKILL, 400ms},
    {"the graphics driver hangs in a picture", kHang, kPictures, "33", 200ms, false, 0, 650ms},
    {"the same, and the program is stopped", kHang, kPictures, "33", 200ms, false, SIGSTOP, 650ms},
    {"the graphics driver draws nothing as a picture expires", kLost, kExpiry, "600", 600ms, true, 0, kLongest},
    {"the graphics driver draws nothing between two pictures", kLost, kPictures, "33", 200ms, false, 0, kLongest},
    {"the same, and what is read back is black", kLost, kExpiry, "600", 600ms, true, 0, kLongest, "READS_ZERO"},
};

void watch_faulty_driver(const char* self, const Monitor& monitor, int rounds, const std::string& folder) {
    const std::string file = folder + "/fail_now";
    setenv("LD_PRELOAD", std::getenv("FAULTY_DRIVER"), 1);
    const test::ScreenPixel eye(monitor);
    for (const DriverFault& fault : kDriverFaults) {
        setenv(fault.setting, fault.value, 1);
        setenv(fault.kind, file.c_str(), 1);
        setenv(fault.reads, "1", 1);
        Instant worst{};
        int never = 0;
        for (int round = 0; round < rounds; ++round) {
            unlink(file.c_str());
            const Holder holder = start_lit_holder(self, monitor.name, eye, fault.name);
            if (fault.fails_before) std::fclose(std::fopen(file.c_str(), "w"));
            std::this_thread::sleep_for(fault.until_fault - (SteadyClock().now() - holder.lit_at));
            if (!fault.fails_before) std::fclose(std::fopen(file.c_str(), "w"));
            if (fault.signal != 0) kill(holder.program, fault.signal);
            if (const auto dark = eye.until_dark(5s))
                worst = std::max(worst, *dark);
            else
                ++never;
            holder.end();
        }
        expect(never == 0 && worst <= fault.longest,
               fmt::format("{}: dark after {:.0f} ms (worst of {}), never {} times", fault.name, 1000 * seconds(worst),
                           rounds, never));
        for (const char* name : {fault.setting, fault.kind, fault.reads}) unsetenv(name);
    }
    unlink(file.c_str());
    unsetenv("LD_PRELOAD");
}

void second_master(const Monitor& monitor) {
    ProjectorProcessSettings settings;
    settings.program = std::getenv("PLANLIGHT");
    const ProjectorProcess first(monitor.name, settings);
    try {
        const ProjectorProcess second(monitor.name, settings);
        expect(false, "a second program is refused the same monitor");
    } catch (const Error& error) {
        expect(std::string(error.what()).find(std::to_string(first.process())) != std::string::npos,
               std::string("a second program is refused by name: ") + error.what());
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc == 3 && std::string(argv[1]) == "hold") {
        try {
            return hold(argv[2]);
        } catch (const Error& error) {
            fmt::print(stderr, "{}\n", error.what());
            return static_cast<int>(error.exit_code);
        }
    }
    const test::DesktopPicture black(0);
    const std::vector<Monitor> monitors = list_monitors();
    if (std::getenv("PLANLIGHT") == nullptr || monitors.size() != 2) return 2;
    const int rounds = std::getenv("ROUNDS") == nullptr ? 3 : std::atoi(std::getenv("ROUNDS"));
    second_master(monitors[1]);
    if (std::getenv("FAULTY_DRIVER") != nullptr)
        watch_faulty_driver(argv[0], monitors[1], rounds, argc > 1 ? argv[1] : "/tmp");
    watch(argv[0], monitors[1], rounds);
    return test::failures() == 0 ? 0 : 1;
}
