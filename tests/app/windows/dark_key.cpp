#include "dark_key.h"

#include <chrono>
#include <random>
#include <stdexcept>
#include <thread>
#include <utility>

// Last, for its macros.
#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <X11/keysym.h>

namespace planlight::test {
namespace {

using namespace std::chrono_literals;
using std::chrono::steady_clock;

constexpr auto kLongest = 2s;

Window window_with(Display* display, Window above, const std::string& title) {
    Window root = 0, parent = 0, *children = nullptr, found = 0;
    unsigned count = 0;
    if (XQueryTree(display, above, &root, &parent, &children, &count) == 0) return 0;
    for (unsigned i = 0; i < count && found == 0; ++i) {
        char* name = nullptr;
        if (XFetchName(display, children[i], &name) != 0 && title == name) found = children[i];
        if (name != nullptr) XFree(name);
        if (found == 0) found = window_with(display, children[i], title);
    }
    if (children != nullptr) XFree(children);
    return found;
}

unsigned long pixel(Display* display, int x, int y) {
    XImage* const image = XGetImage(display, DefaultRootWindow(display), x, y, 1, 1, AllPlanes, ZPixmap);
    const unsigned long value = XGetPixel(image, 0, 0) & 0xFFFFFF;
    XDestroyImage(image);
    return value;
}

void send_key(Display* display, Window window, KeySym key) {
    XKeyEvent event{};
    event.display = display;
    event.window = window;
    event.root = DefaultRootWindow(display);
    event.same_screen = True;
    event.keycode = XKeysymToKeycode(display, key);
    for (const auto& [type, mask] : {std::pair(KeyPress, KeyPressMask), std::pair(KeyRelease, KeyReleaseMask)}) {
        event.type = type;
        XSendEvent(display, window, True, mask, reinterpret_cast<XEvent*>(&event));
        XFlush(display);
    }
}

}  // namespace

std::vector<double> dark_key_to_banner_ms(const std::string& title, int x, int y, int presses,
                                          std::atomic<bool>& dark) {
    Display* const display = XOpenDisplay(nullptr);
    if (display == nullptr) throw std::runtime_error("no display");
    const Window window = window_with(display, DefaultRootWindow(display), title);
    if (window == 0) throw std::runtime_error("no window " + title);
    std::vector<double> to_banner_ms;
    std::mt19937 random(7);
    std::uniform_int_distribution<int> wait_ms(150, 400);
    const unsigned long before = pixel(display, x, y);
    for (int i = 0; i < presses; ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(wait_ms(random)));
        const auto pressed = steady_clock::now();
        send_key(display, window, XK_space);
        while (pixel(display, x, y) == before && steady_clock::now() - pressed < kLongest)
            std::this_thread::sleep_for(1ms);
        to_banner_ms.push_back(std::chrono::duration<double, std::milli>(steady_clock::now() - pressed).count());
        dark = false;
        const auto since = steady_clock::now();
        while (pixel(display, x, y) != before && steady_clock::now() - since < kLongest)
            std::this_thread::sleep_for(1ms);
    }
    XCloseDisplay(display);
    return to_banner_ms;
}

}  // namespace planlight::test
