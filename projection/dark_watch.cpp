#include "projection/dark_watch.h"

#include <X11/Xutil.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <optional>
#include <thread>
#include <utility>

#include "planning_io/types/steady_clock.h"
#include "projection/black_gamma.h"
#include "projection/projector_output.h"
#include "projection/x11_errors.h"
#include "projection/x11_pointers.h"

namespace planlight {
namespace {

constexpr auto kPoll = std::chrono::milliseconds(10);
constexpr Instant kToGoDark = std::chrono::milliseconds(200);  ///< expiry, and a compositor's next picture
constexpr Instant kOften = std::chrono::milliseconds(30);      ///< between looks, as it has just become dark
constexpr Instant kSeldom = std::chrono::milliseconds(2000);   ///< and later
constexpr Instant kJustNow = std::chrono::milliseconds(1000);
constexpr int kLooks = 2;  ///< one after the other, for a window may come and go
constexpr int kLeastPixels = 20;
constexpr std::uint32_t kBright = 0xE0E0E0;  ///< the bits of a channel of 32 or more

/// Whether anything is lit there; false where the X server gives no picture.
bool is_lit(Display* display, const ProjectorOutput& at) {
    XImage* const image = XGetImage(display, DefaultRootWindow(display), at.x, at.y, static_cast<unsigned>(at.width),
                                    static_cast<unsigned>(at.height), AllPlanes, ZPixmap);
    if (image == nullptr) return false;
    int lit = 0;
    for (int y = 0; y < image->height && image->bits_per_pixel == 32 && lit < kLeastPixels; ++y) {
        const auto* const row = reinterpret_cast<const std::uint32_t*>(image->data + static_cast<std::ptrdiff_t>(y) *
                                                                                         image->bytes_per_line);
        for (int x = 0; x < image->width; ++x) lit += (row[x] & kBright) != 0;
    }
    XDestroyImage(image);
    return lit >= kLeastPixels;
}

}  // namespace

struct DarkWatch::Parts {
    std::string monitor;
    SteadyClock clock;
    std::atomic<Instant::rep> dark_from;
    std::atomic<State> state = State::as_it_should;
    std::jthread thread;

    explicit Parts(std::string name) : monitor(std::move(name)), dark_from(clock.now().count()) {
        thread = std::jthread([this](const std::stop_token& stop) { run(stop); });
    }

    /// Black should be seen by now, and it is time to look.
    bool due(Instant looked_at) const {
        const Instant dark_for = clock.now() - Instant(dark_from.load());
        if (dark_for < kToGoDark) return false;
        const bool often = dark_for < kToGoDark + kJustNow || state != State::as_it_should;
        return clock.now() - looked_at >= (often ? kOften : kSeldom);
    }

    void run(const std::stop_token& stop) {
        const X11Display connection(XOpenDisplay(nullptr));
        if (!connection) return;
        forgive_errors_on(connection.get());
        BlackGamma gamma(connection.get());
        if (const auto output = projector_output(connection.get(), monitor)) gamma.mend(*output);
        Instant looked_at{};
        int lit_looks = 0, dark_looks = 0;
        std::optional<Instant::rep> judged;  // the darkness that the last verdict was of
        for (; !stop.stop_requested() || judged != dark_from; std::this_thread::sleep_for(kPoll)) {
            if (!due(looked_at)) continue;
            const Instant::rep asked_of = dark_from;
            looked_at = clock.now();
            const auto output = projector_output(connection.get(), monitor);
            const bool lit = output && is_lit(connection.get(), *output);
            if (dark_from != asked_of) continue;  // a picture may have come meanwhile
            lit_looks = lit ? lit_looks + 1 : 0;
            dark_looks = lit ? 0 : dark_looks + 1;
            if (lit_looks >= kLooks) state = gamma.blacken(*output) ? State::blackened : State::lit;
            if (dark_looks >= kLooks) gamma.restore(), state = State::as_it_should;
            if (lit_looks >= kLooks || dark_looks > 0) judged = asked_of;
        }
        forget_errors_on(connection.get());
    }
};

DarkWatch::DarkWatch(std::string monitor) : parts_(std::make_unique<Parts>(std::move(monitor))) {}
DarkWatch::~DarkWatch() {
    expect_dark_by(parts_->clock.now());
}

void DarkWatch::expect_dark_from(Instant moment) {
    parts_->dark_from = moment.count();
}

void DarkWatch::expect_dark_by(Instant moment) {
    Instant::rep before = parts_->dark_from;
    while (before > moment.count() && !parts_->dark_from.compare_exchange_weak(before, moment.count())) {
    }
}

DarkWatch::State DarkWatch::state() const {
    return parts_->state;
}

}  // namespace planlight
