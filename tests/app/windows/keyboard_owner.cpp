#include "keyboard_owner.h"

#include <X11/Xlib.h>

#include <stdexcept>

namespace planlight::test {

std::string keyboard_owner() {
    Display* const display = XOpenDisplay(nullptr);
    if (display == nullptr) throw std::runtime_error("no display");
    Window window = 0;
    int revert = 0;
    XGetInputFocus(display, &window, &revert);
    std::string owner;
    char* name = nullptr;
    if (window > PointerRoot && XFetchName(display, window, &name) != 0 && name != nullptr) {
        owner = name;
        XFree(name);
    }
    XCloseDisplay(display);
    return owner;
}

KeyboardTaken::KeyboardTaken() {
    Display* const display = XOpenDisplay(nullptr);
    if (display == nullptr) throw std::runtime_error("no display");
    display_ = display;
    XSetWindowAttributes wanted{};
    wanted.override_redirect = True;
    const Window window = XCreateWindow(display, DefaultRootWindow(display), 0, 0, 1, 1, 0, 0, InputOnly, nullptr,
                                        CWOverrideRedirect, &wanted);
    XMapWindow(display, window);
    XSetInputFocus(display, window, RevertToPointerRoot, CurrentTime);
    XSync(display, False);
}

KeyboardTaken::~KeyboardTaken() {
    XCloseDisplay(static_cast<Display*>(display_));
}

}  // namespace planlight::test
