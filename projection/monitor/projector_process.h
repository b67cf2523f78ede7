#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <mutex>
#include <string>

#include "planning_io/types/error.h"
#include "planning_io/types/steady_clock.h"
#include "projection/monitor/light_mailbox.h"
#include "registration/devices/projector.h"

namespace planlight {

/// Times of the lease and of the watch over the process that owns the monitor.
struct ProjectorProcessSettings {
    std::filesystem::path program = "/proc/self/exe";          ///< run as `PROGRAM projector-window ...`
    Instant light_delay = std::chrono::milliseconds(25);       ///< from the swap to light on the skin
    Instant lease = std::chrono::milliseconds(200);            ///< the light outlives the last `renew` by this at most
    Instant silence_allowed = std::chrono::milliseconds(200);  ///< of the projector process; then it is ended
    /// For one order to come to the display, or one look at the window system; then it is ended as well.
    Instant work_allowed = std::chrono::milliseconds(700);
    Instant start_allowed = std::chrono::seconds(10);
};

/// One that was killed and does not go, for it hangs in the graphics driver: its window may stay, lit.
class UnendedProjector : public DeviceError {
public:
    using DeviceError::DeviceError;
};

/// Whether there is such a one, of this program, now.
bool a_projector_process_hangs();

/// The projector window in a process of its own, so that a program that hangs, is stopped or is killed cannot leave its
/// light on a patient: each picture has its expiry, and all light a lease that this process must renew. All moments are
/// of the wall's monotonic clock (`SteadyClock`).
///
/// May be used from any thread.
class ProjectorProcess final : public Projector {
public:
    /// Starts it on that monitor (a name, or its number as text) and waits until its window is black there. Throws
    /// DeviceError as `ProjectorWindow` does, when another Planlight lights that monitor, or when one that was killed
    /// before has still not gone.
    explicit ProjectorProcess(const std::string& monitor, const ProjectorProcessSettings& settings = {});
    ~ProjectorProcess() override;
    ProjectorProcess(const ProjectorProcess&) = delete;
    ProjectorProcess& operator=(const ProjectorProcess&) = delete;

    int width() const override { return width_; }
    int height() const override { return height_; }
    /// The name of its monitor. It stays, where a number means another monitor once one was unplugged.
    const std::string& monitor() const { return monitor_; }

    /// Returns when the picture is on the display. Throws DeviceError, with the process ended and so dark, when it does
    /// not come there, the monitor is gone or the window does not cover it. A window's first picture may take longer
    /// than a lease: it is renewed while this waits, as long as `permitted` says so (empty: always).
    Instant show(const RgbImage& picture, Instant valid_until, const std::function<bool()>& permitted);
    Instant show(const RgbImage& picture, Instant valid_until) override { return show(picture, valid_until, {}); }
    void go_dark() noexcept override;

    /// Keeps the light for another lease. To be called while everything that the light depends on is alive.
    void renew();

    /// Looks whether the process still answers; throws DeviceError, with it ended and so dark, when it does not (or, as
    /// it says then, killed and not gone, for it hangs in the graphics driver: its light may still be on). To be
    /// called at least ten times a second: a projector process that was stopped keeps its last picture until this ends
    /// it.
    void check();

    pid_t process() const { return process_; }

private:
    void start(const std::string& monitor);
    void wait_until_ready();
    [[noreturn]] void fail(const std::string& problem, const std::string& remedy);
    void check_locked();
    void wait_until_done(std::uint64_t number, const std::function<void()>& meanwhile);
    void wake();
    bool end() noexcept;  ///< false: killed, and not gone yet; its window may stay
    [[noreturn]] void throw_ended(const std::string& problem);

    ProjectorProcessSettings settings_;
    SteadyClock clock_;
    LightMailbox mailbox_;
    std::mutex mutex_;
    pid_t process_ = -1;
    bool unended_ = false;  ///< it was killed and did not go
    int bell_ = -1;         ///< a byte here wakes the process; its end tells it that we are gone
    int width_ = 0, height_ = 0;
    std::string monitor_;
};

/// The descriptors that the projector process finds open.
inline constexpr int kProjectorBell = 3, kProjectorMailbox = 4;

/// What the projector process does: opens the window on `monitor`, shows what the mailbox behind `descriptor` orders,
/// dark whenever picture or lease has expired, until `bell` says that the program is gone. Gives its exit code; what
/// went wrong stands in the mailbox.
int serve_projector(const std::string& monitor, int bell, int descriptor);

}  // namespace planlight
