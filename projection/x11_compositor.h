#pragma once

#include <X11/Xlib.h>

#include <string>

namespace planlight {

/// Whether a compositor draws the windows of the display's default screen (EWMH, `_NET_WM_CM_Sn`).
inline bool is_composited(Display* display) {
    const std::string owner = "_NET_WM_CM_S" + std::to_string(DefaultScreen(display));
    const Atom selection = XInternAtom(display, owner.c_str(), True);
    return selection != None && XGetSelectionOwner(display, selection) != None;
}

}  // namespace planlight
