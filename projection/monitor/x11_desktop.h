#pragma once

#include <X11/Xlib.h>
#include <X11/extensions/Xrandr.h>

#include <string>

#include "projection/monitor/x11_pointers.h"

namespace planlight {

/// Whether a compositor draws the windows of the display's default screen (EWMH, `_NET_WM_CM_Sn`).
inline bool is_composited(Display* display) {
    const std::string owner = "_NET_WM_CM_S" + std::to_string(DefaultScreen(display));
    const Atom selection = XInternAtom(display, owner.c_str(), True);
    return selection != None && XGetSelectionOwner(display, selection) != None;
}

/// Whether the X server is one of a Wayland desktop's (Xwayland), which shows what X11 programs draw as that desktop
/// likes: by its extension (since 23.1), or as earlier ones name their outputs.
inline bool is_wayland(Display* display) {
    int opcode = 0, event = 0, error = 0, count = 0;
    if (XQueryExtension(display, "XWAYLAND", &opcode, &event, &error) == True) return true;
    const X11Pointer<XRRMonitorInfo, XRRFreeMonitors> all(
        XRRGetMonitors(display, DefaultRootWindow(display), True, &count));
    for (int i = 0; i < count; ++i) {
        const X11Pointer<char, XFree> name(XGetAtomName(display, all.get()[i].name));
        if (name && std::string(name.get()).starts_with("XWAYLAND")) return true;
    }
    return false;
}

}  // namespace planlight
