#include "desktop_picture.h"

#include <X11/Xatom.h>
#include <X11/Xlib.h>

#include <stdexcept>

namespace planlight::test {

DesktopPicture::DesktopPicture(unsigned long colour) : display_(XOpenDisplay(nullptr)) {
    auto* const display = static_cast<Display*>(display_);
    if (display == nullptr) throw std::runtime_error("no display");
    const int screen = DefaultScreen(display);
    const ::Window root = RootWindow(display, screen);
    const auto width = static_cast<unsigned>(DisplayWidth(display, screen)),
               height = static_cast<unsigned>(DisplayHeight(display, screen));
    const Pixmap picture =
        XCreatePixmap(display, root, width, height, static_cast<unsigned>(DefaultDepth(display, screen)));
    XSetForeground(display, DefaultGC(display, screen), colour);
    XFillRectangle(display, picture, DefaultGC(display, screen), 0, 0, width, height);
    XSetWindowBackgroundPixmap(display, root, picture);
    XClearWindow(display, root);
    XChangeProperty(display, root, XInternAtom(display, "_XROOTPMAP_ID", False), XA_PIXMAP, 32, PropModeReplace,
                    reinterpret_cast<const unsigned char*>(&picture), 1);
    XSync(display, False);
}

DesktopPicture::~DesktopPicture() {
    XCloseDisplay(static_cast<Display*>(display_));
}

}  // namespace planlight::test
