#include "projection/monitor/monitor_picture.h"

#include "planning_io/types/error.h"
#include "projection/monitor/projector_window.h"

// Last: its macros are everywhere.
#include <X11/Xutil.h>

#include "projection/monitor/x11_pointers.h"

namespace planlight {

struct MonitorPicture::Parts {
    Monitor monitor;
    X11Display display;
};

MonitorPicture::MonitorPicture(const std::string& name) : parts_(std::make_unique<Parts>()) {
    for (const Monitor& monitor : list_monitors())
        if (monitor.name == name) parts_->monitor = monitor;
    if (parts_->monitor.name.empty())
        throw DeviceError("Monitor " + name, "there is none of this name", "See `planlight devices`.");
    parts_->display.reset(XOpenDisplay(nullptr));
    if (!parts_->display)
        throw DeviceError("Monitor " + name, "there is no X display", "Start it in a graphical session.");
}

MonitorPicture::~MonitorPicture() = default;

int MonitorPicture::width() const {
    return parts_->monitor.width;
}
int MonitorPicture::height() const {
    return parts_->monitor.height;
}

RgbImage MonitorPicture::look() {
    const Monitor& m = parts_->monitor;
    Display* const display = parts_->display.get();
    // X ends a program that asks for what lies beyond the screen, as a monitor may once it was set anew.
    XWindowAttributes screen{};
    if (XGetWindowAttributes(display, DefaultRootWindow(display), &screen) == 0 || m.x < 0 || m.y < 0 ||
        m.x + m.width > screen.width || m.y + m.height > screen.height)
        throw DeviceError("Monitor " + m.name, "it lies no longer within the screen",
                          "Set its mode and place again, and start anew.");
    XImage* const image = XGetImage(display, DefaultRootWindow(display), m.x, m.y, static_cast<unsigned>(m.width),
                                    static_cast<unsigned>(m.height), AllPlanes, ZPixmap);
    if (!image || image->bits_per_pixel != 32)
        throw DeviceError("Monitor " + m.name, "its picture cannot be read", "Use a display of 24 bits a pixel.");
    RgbImage picture(m.width, m.height);
    for (int y = 0; y < m.height; ++y) {
        const auto* row = reinterpret_cast<const unsigned char*>(image->data) +
                          static_cast<std::size_t>(y) * static_cast<std::size_t>(image->bytes_per_line);
        for (int x = 0; x < m.width; ++x, row += 4) picture.at(x, y) = {row[2], row[1], row[0]};
    }
    XDestroyImage(image);
    return picture;
}

}  // namespace planlight
