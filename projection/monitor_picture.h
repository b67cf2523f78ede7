#pragma once

#include <memory>
#include <string>

#include "planning_io/types/image.h"

namespace planlight {

/// What stands on a monitor, read back from the window system: for rooms that are simulated and for tests. Not for the
/// projector's own light, which nothing but a camera can see.
class MonitorPicture {
public:
    /// By name. Throws DeviceError when there is no such monitor or no display.
    explicit MonitorPicture(const std::string& monitor);
    ~MonitorPicture();

    int width() const;
    int height() const;
    /// Throws DeviceError when the monitor is gone.
    RgbImage look();

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

/// Whether a compositor draws the desktop's windows (EWMH, _NET_WM_CM_Sn): what is asked of a window then is not what
/// is seen. False where there is no X display.
bool desktop_is_composited();

/// Whether it is a Wayland desktop, whose X server does not know what is seen of its windows; `ProjectorWindow` refuses
/// it.
bool desktop_is_wayland();

}  // namespace planlight
