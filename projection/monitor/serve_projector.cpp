// The projector process: a window, a mailbox, and a lease.
#include <poll.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <thread>

#include "planning_io/types/error.h"
#include "planning_io/types/suspend_watch.h"
#include "projection/monitor/projector_process.h"
#include "projection/monitor/projector_window.h"
#include "projection/monitor/realtime_priority.h"

namespace planlight {
namespace {

constexpr int kPoll_ms = 5;

/// The wall's monotonic clock while the lease lasts, the end of time afterwards: every picture has expired then, also
/// for the thread that owns it while this one hangs.
class LeasedClock final : public Clock {
public:
    explicit LeasedClock(const LightMailbox& mailbox) : mailbox_(mailbox) {}
    Instant now() const override {
        const Instant now = clock_.now();
        return now < mailbox_.lease_until() ? now : Instant::max() / 2;
    }

private:
    const LightMailbox& mailbox_;
    SteadyClock clock_;
};

/// Waits for a ring or a while; false when the program is gone.
bool wait_for_bell(int bell) {
    pollfd waiting{bell, POLLIN, 0};
    if (poll(&waiting, 1, kPoll_ms) <= 0) return true;
    char bytes[64];
    return (waiting.revents & POLLIN) != 0 && read(bell, bytes, sizeof bytes) > 0;
}

/// Says every few milliseconds that this process runs: it is neither stopped nor starved.
class Pulse {
public:
    explicit Pulse(LightMailbox& mailbox)
        : thread_([&mailbox](const std::stop_token& stop) {
              while (!stop.stop_requested()) {
                  mailbox.say_alive(SteadyClock().now());
                  std::this_thread::sleep_for(std::chrono::milliseconds(10));
              }
          }) {
        mailbox.say_alive(SteadyClock().now());
    }

private:
    std::jthread thread_;
};

/// The process, and its window with it, outlives the program by a moment only, whatever it waits for in the graphics
/// driver.
void end_with_program(int bell) {
    std::thread([bell] {
        constexpr auto kToGoDark = std::chrono::milliseconds(250);
        pollfd program{bell, 0, 0};  // asked for nothing but its end
        while (poll(&program, 1, -1) < 0 && errno == EINTR) {
        }
        std::this_thread::sleep_for(kToGoDark);
        std::_Exit(static_cast<int>(ExitCode::device));
    }).detach();
}

void follow(ProjectorWindow& window, LightMailbox& mailbox, int bell) {
    const SteadyClock clock;
    const Pulse pulse(mailbox);
    LightMailbox::Order order;
    mailbox.say_ready(window.width(), window.height(), window.monitor());
    SuspendWatch suspend;
    do {
        if (suspend.look())
            throw DeviceError("Projector", "the computer was asleep",
                              "Look at the light on landmarks before you use it, and switch the computer's sleep off.");
        mailbox.say_busy(clock.now());
        const bool ordered = mailbox.take(order);
        if (ordered && order.picture.empty()) window.go_dark();
        if (ordered && !order.picture.empty()) window.show(order.picture, order.valid_until);
        const Instant done_at = clock.now();
        window.refresh();  // throws where it could not be done, also darkness: the process ends then, and its window
        if (ordered) mailbox.say_done(order.number, done_at);
        mailbox.say_busy({});
    } while (wait_for_bell(bell));
}

/// A fault ends the process at once: a window that is taken down in order would wait for a driver that hangs, lit.
void follow_or_end(ProjectorWindow& window, LightMailbox& mailbox, int bell) {
    try {
        follow(window, mailbox, bell);
        return;
    } catch (const Error& error) {
        mailbox.say_failed(error.what(), error.remedy);
    } catch (const std::exception& error) {
        mailbox.say_failed(std::string("projector process: ") + error.what(), "Report this.");
    }
    std::_Exit(static_cast<int>(ExitCode::device));
}

}  // namespace

int serve_projector(const std::string& monitor, int bell, int descriptor) {
    // What a terminal sends, Ctrl-C and Ctrl-Z say, is for the program; this process must never stop while it is lit.
    for (const int signal : {SIGINT, SIGHUP, SIGTSTP, SIGTTOU, SIGTTIN}) std::signal(signal, SIG_IGN);
    if (!request_realtime_priority()) setpriority(PRIO_PROCESS, 0, -10);  // where the system allows either
    LightMailbox mailbox(descriptor);
    end_with_program(bell);
    try {
        const LeasedClock clock(mailbox);
        ProjectorWindow window(monitor, clock);
        follow_or_end(window, mailbox, bell);
        return 0;
    } catch (const Error& error) {
        mailbox.say_failed(error.what(), error.remedy);
    } catch (const std::exception& error) {
        mailbox.say_failed(std::string("projector process: ") + error.what(), "Report this.");
    }
    return static_cast<int>(ExitCode::device);
}

}  // namespace planlight
