#include "projection/monitor/monitors_kept_on.h"

#include <X11/Xlib.h>
#include <X11/extensions/dpms.h>
#include <X11/extensions/scrnsaver.h>

#include <algorithm>
#include <chrono>

#include "projection/monitor/x11_pointers.h"

namespace planlight {
namespace {

constexpr auto kTellEvery = std::chrono::seconds(30);

bool can_suspend(Display* display) {
    int event = 0, error = 0, major = 0, minor = 0;
    return XScreenSaverQueryExtension(display, &event, &error) != 0 &&
           XScreenSaverQueryVersion(display, &major, &minor) != 0 && (major > 1 || (major == 1 && minor >= 1));
}

/// Power saving is there and switched on; the level it is at.
std::optional<CARD16> power_level(Display* display) {
    int event = 0, error = 0;
    CARD16 level = 0;
    BOOL on = False;
    if (DPMSQueryExtension(display, &event, &error) == 0 || DPMSCapable(display) == 0) return std::nullopt;
    if (DPMSInfo(display, &level, &on) == 0 || on == False) return std::nullopt;
    return level;
}

}  // namespace

struct MonitorsKeptOn::Connection {
    X11Display display{XOpenDisplay(nullptr)};
};

MonitorsKeptOn::MonitorsKeptOn() : connection_(std::make_unique<Connection>()) {
    Display* const display = connection_->display.get();
    if (display == nullptr) return;
    if (can_suspend(display)) XScreenSaverSuspend(display, True);
    if (const auto level = power_level(display); level && *level != DPMSModeOn) DPMSForceLevel(display, DPMSModeOn);
    XResetScreenSaver(display);
    XSync(display, False);
    thread_ = std::jthread([this](const std::stop_token& stop) {
        std::unique_lock lock(mutex_);
        while (!ended_.wait_for(lock, stop, kTellEvery, [] { return false; }) && !stop.stop_requested()) {
            XResetScreenSaver(connection_->display.get());
            XFlush(connection_->display.get());
        }
    });
}

MonitorsKeptOn::~MonitorsKeptOn() {
    thread_ = {};  // before its connection
}

std::optional<MonitorsDarkAfter> monitors_dark_after() {
    const X11Display opened(XOpenDisplay(nullptr));
    Display* const display = opened.get();
    if (display == nullptr) return std::nullopt;
    MonitorsDarkAfter dark;
    const auto after = [&](int time_s) {
        if (time_s > 0) dark.unused_s = std::min(time_s, dark.unused_s.value_or(time_s));
    };
    int time_s = 0, interval_s = 0, blanking = 0, exposures = 0;
    XGetScreenSaver(display, &time_s, &interval_s, &blanking, &exposures);
    after(time_s);
    CARD16 standby_s = 0, suspend_s = 0, off_s = 0;
    if (power_level(display) && DPMSGetTimeouts(display, &standby_s, &suspend_s, &off_s) != 0)
        for (const CARD16 one_s : {standby_s, suspend_s, off_s}) after(one_s);
    dark.can_be_kept_on = can_suspend(display);
    return dark;
}

}  // namespace planlight
