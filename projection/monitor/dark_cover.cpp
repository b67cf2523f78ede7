#include "projection/monitor/dark_cover.h"

#include <X11/Xlib.h>

#include <utility>

#include "projection/monitor/projector_output.h"
#include "projection/monitor/x11_pointers.h"

namespace planlight {

struct DarkCover::Parts {
    std::string monitor;
    X11Display connection;
    ::Window window = 0;  ///< goes with its connection

    void make() {
        Display* const display = connection.get();
        XSetWindowAttributes wanted{};
        wanted.override_redirect = True;
        wanted.background_pixel = BlackPixel(display, DefaultScreen(display));
        window = XCreateWindow(display, DefaultRootWindow(display), 0, 0, 1, 1, 0, CopyFromParent, InputOutput, nullptr,
                               CWOverrideRedirect | CWBackPixel, &wanted);
        XStoreName(display, window, "Planlight dark");
        const char nothing[1] = {0};
        const Pixmap empty = XCreateBitmapFromData(display, window, nothing, 1, 1);
        XColor black{};
        const Cursor no_cursor = XCreatePixmapCursor(display, empty, empty, &black, &black, 0, 0);
        XDefineCursor(display, window, no_cursor);
        XFreeCursor(display, no_cursor);
        XFreePixmap(display, empty);
    }
};

DarkCover::DarkCover(std::string monitor) : parts_(std::make_unique<Parts>()) {
    parts_->monitor = std::move(monitor);
}
DarkCover::~DarkCover() = default;

void DarkCover::cover() noexcept {
    if (!parts_->connection) parts_->connection.reset(XOpenDisplay(nullptr));
    Display* const display = parts_->connection.get();
    if (display == nullptr) return;
    const auto monitor = projector_output(display, parts_->monitor);
    if (!monitor) {
        uncover();
        return;
    }
    if (parts_->window == 0) parts_->make();
    XMoveResizeWindow(display, parts_->window, monitor->x, monitor->y, static_cast<unsigned>(monitor->width),
                      static_cast<unsigned>(monitor->height));
    XMapRaised(display, parts_->window);
    XSync(display, False);
}

void DarkCover::uncover() noexcept {
    if (parts_->window == 0) return;
    XUnmapWindow(parts_->connection.get(), parts_->window);
    XSync(parts_->connection.get(), False);
}

}  // namespace planlight
