#include "screen_pixel.h"

#include <X11/Xlib.h>
#include <X11/Xutil.h>

#include <stdexcept>
#include <thread>

#include "planning_io/types/steady_clock.h"

namespace planlight::test {

ScreenPixel::ScreenPixel(const Monitor& monitor)
    : display_(XOpenDisplay(nullptr)), x_(monitor.x + monitor.width / 2), y_(monitor.y + monitor.height / 2) {
    if (display_ == nullptr) throw std::runtime_error("no display");
}

ScreenPixel::~ScreenPixel() {
    XCloseDisplay(static_cast<Display*>(display_));
}

unsigned ScreenPixel::colour() const {
    auto* const display = static_cast<Display*>(display_);
    XImage* const image = XGetImage(display, DefaultRootWindow(display), x_, y_, 1, 1, AllPlanes, ZPixmap);
    const auto colour = static_cast<unsigned>(XGetPixel(image, 0, 0) & 0xFFFFFF);
    XDestroyImage(image);
    return colour;
}

namespace {

template <class Fact>
bool becomes_true(const Fact& fact, Instant patience) {
    const SteadyClock clock;
    for (const Instant until = clock.now() + patience; clock.now() < until;
         std::this_thread::sleep_for(std::chrono::milliseconds(1)))
        if (fact()) return true;
    return fact();
}

}  // namespace

bool ScreenPixel::shows_soon(unsigned wanted, Instant patience) const {
    return becomes_true([&] { return colour() == wanted; }, patience);
}

bool ScreenPixel::lit_soon(Instant patience) const {
    return becomes_true([&] { return lit(); }, patience);
}

std::optional<Instant> ScreenPixel::until_dark(Instant patience) const {
    const SteadyClock clock;
    const Instant start = clock.now();
    while (lit()) {
        if (clock.now() - start > patience) return std::nullopt;
        std::this_thread::sleep_for(std::chrono::microseconds(500));
    }
    return clock.now() - start;
}

}  // namespace planlight::test
