#pragma once

#include <memory>
#include <string>
#include <vector>

#include "registration/devices/projector.h"

namespace planlight {

/// A monitor as the window system names it.
struct Monitor {
    std::string name;
    int x = 0, y = 0, width = 0, height = 0;  ///< virtual desktop pixels
    bool primary = false;
    double refresh_hz = 0;      ///< 0: not known
    std::string model, serial;  ///< of its EDID, where X11 tells one; else empty
};

/// The monitors there are now. Throws DeviceError when there is no display at all.
std::vector<Monitor> list_monitors();

/// Which monitor, and how its window is made.
struct ProjectorWindowSettings {
    Instant light_delay = std::chrono::milliseconds(25);  ///< from the swap to light on the skin: display and lamp
};

/// The projector as an undecorated window that covers exactly one monitor. Black by itself when a picture has expired,
/// also when the program hangs: a thread of its own owns the picture (and reads the clock, which must allow that).
///
/// All members are called from the main thread.
class ProjectorWindow final : public Projector {
public:
    /// Opens on the monitor of that name (or index as text). Throws DeviceError when there is no such monitor, when it
    /// is the only one or the primary one and `allow_only_monitor` is false, when another process lights it, or when
    /// the window does not land exactly on it.
    ProjectorWindow(const std::string& monitor, const Clock& clock, bool allow_only_monitor = false,
                    const ProjectorWindowSettings& settings = {});
    ~ProjectorWindow() override;

    int width() const override;
    int height() const override;
    const std::string& monitor() const;  ///< its name, also where it was asked for by its number
    Instant show(const RgbImage& picture, Instant valid_until) override;
    void go_dark() noexcept override;

    /// To be called often: darkens an expired picture, checks that the window still covers its monitor and nothing
    /// else, and that its picture or its darkness could be drawn. Throws DeviceError when one does not hold (monitor
    /// unplugged, window moved, graphics driver failed); the window is dark and hidden then.
    void refresh();
    bool dark() const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace planlight
