#include "projection/monitor/desktop_kind.h"

#include <X11/Xlib.h>

#include "projection/monitor/x11_desktop.h"
#include "projection/monitor/x11_pointers.h"

namespace planlight {

bool desktop_is_composited() {
    const X11Display display(XOpenDisplay(nullptr));
    return display && is_composited(display.get());
}

bool desktop_is_wayland() {
    const X11Display display(XOpenDisplay(nullptr));
    return display && is_wayland(display.get());
}

}  // namespace planlight
