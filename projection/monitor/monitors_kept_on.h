#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

namespace planlight {

/// While one exists, X11 does not switch a monitor off or blank it because nobody touches keyboard or mouse: the light
/// would go out in the middle of an operation. Those that are off are switched on.
///
/// Nobody's settings are changed: X11 is asked to wait (MIT-SCREEN-SAVER 1.1), and ends that by itself with the last of
/// this process, also when that was killed; what else looks how long nobody did anything (a power manager, a locker) is
/// told every half minute that somebody did. Where there is no X11, or it cannot do this, nothing happens.
class MonitorsKeptOn {
public:
    MonitorsKeptOn();
    ~MonitorsKeptOn();
    MonitorsKeptOn(const MonitorsKeptOn&) = delete;
    MonitorsKeptOn& operator=(const MonitorsKeptOn&) = delete;

private:
    struct Connection;
    std::unique_ptr<Connection> connection_;  ///< of its own
    std::mutex mutex_;
    std::condition_variable_any ended_;
    std::jthread thread_;
};

/// When X11 makes its monitors dark by itself, as it is set.
struct MonitorsDarkAfter {
    std::optional<int> unused_s;  ///< saver or power saving, whichever comes first; empty: never
    bool can_be_kept_on = false;  ///< `MonitorsKeptOn` has what it takes
};

/// Empty where no X11 display answers.
std::optional<MonitorsDarkAfter> monitors_dark_after();

}  // namespace planlight
