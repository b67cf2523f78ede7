// Prints what the screen saver of X11 does: on, off (it waits), or disabled.
#include <X11/Xlib.h>
#include <X11/extensions/scrnsaver.h>

#include <cstdio>

int main() {
    Display* const display = XOpenDisplay(nullptr);
    if (display == nullptr) return 1;
    XScreenSaverInfo* const info = XScreenSaverAllocInfo();
    XScreenSaverQueryInfo(display, DefaultRootWindow(display), info);
    std::puts(info->state == ScreenSaverOn ? "on" : info->state == ScreenSaverOff ? "off" : "disabled");
    XFree(info);
    XCloseDisplay(display);
}
