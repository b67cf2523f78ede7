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

}  // namespace planlight
