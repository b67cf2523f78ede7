#include "projection/monitor/dark_watch.h"

#include <X11/Xutil.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <optional>
#include <thread>
#include <utility>

#include "planning_io/types/steady_clock.h"
#include "projection/monitor/black_gamma.h"
#include "projection/monitor/projector_output.h"
#include "projection/monitor/x11_errors.h"
#include "projection/monitor/x11_pointers.h"

namespace planlight {
namespace {

constexpr auto kPoll = std::chrono::milliseconds(10);
constexpr Instant kToGoDark = std::chrono::milliseconds(200);  ///< expiry, and a compositor's next picture
constexpr Instant kAgain = std::chrono::milliseconds(30);      ///< between looks, until one was black
constexpr Instant kWhileBlack = std::chrono::milliseconds(150);
constexpr Instant kSeldom = std::chrono::milliseconds(2000);  ///< a whole picture is read each time
constexpr Instant kLongestEnd = std::chrono::milliseconds(1000);
constexpr int kLooks = 2;  ///< one after the other, for a window may come and go
constexpr int kLeastPixels = 20;

/// Whether anything is lit there; empty where the X server does not tell.
std::optional<bool> is_lit(Display* display, const ProjectorOutput& at) {
    XImage* const image = XGetImage(display, DefaultRootWindow(display), at.x, at.y, static_cast<unsigned>(at.width),
                                    static_cast<unsigned>(at.height), AllPlanes, ZPixmap);
    if (image == nullptr) return std::nullopt;
    std::optional<bool> verdict;
    if (image->bits_per_pixel == 32) {
        std::uint32_t bright = 0;  // the three highest bits of each colour
        for (const unsigned long mask : {image->red_mask, image->green_mask, image->blue_mask}) {
            const auto bits = static_cast<std::uint32_t>(mask);
            bright |= bits & ~(bits >> 3);
        }
        int lit = 0;
        for (int y = 0; y < image->height && lit < kLeastPixels; ++y) {
            const auto* const row = reinterpret_cast<const std::uint32_t*>(
                image->data + static_cast<std::ptrdiff_t>(y) * image->bytes_per_line);
            for (int x = 0; x < image->width; ++x) lit += (row[x] & bright) != 0;
        }
        verdict = lit >= kLeastPixels;
    }
    XDestroyImage(image);
    return verdict;
}

}  // namespace

struct DarkWatch::Parts {
    std::string monitor;
    SteadyClock clock;
    std::atomic<Instant::rep> dark_from;
    std::atomic<State> state = State::as_it_should;
    std::jthread thread;

    explicit Parts(std::string name) : monitor(std::move(name)), dark_from(clock.now().count()) {
        X11Display connection(XOpenDisplay(nullptr));
        if (!connection) return;
        forgive_errors_on(connection.get());
        thread = std::jthread([this, c = std::move(connection)](const std::stop_token& stop) {
            run(c.get(), stop);
            forget_errors_on(c.get());
        });
    }

    /// What was seen of one darkness.
    struct Darkness {
        Instant::rep from = 0;
        int lit_looks = 0, dark_looks = 0;

        bool judged() const { return lit_looks >= kLooks || dark_looks > 0; }
    };

    bool due(const Darkness& seen, Instant looked_at) const {
        const Instant now = clock.now();
        if (now - Instant(dark_from.load()) < kToGoDark) return false;
        const bool known = seen.from == dark_from && seen.dark_looks > 0;
        return now - looked_at >= (state != State::as_it_should ? kWhileBlack : known ? kSeldom : kAgain);
    }

    void run(Display* display, const std::stop_token& stop) {
        BlackGamma gamma(display);
        if (const auto output = projector_output(display, monitor)) gamma.take_over(*output);
        if (gamma.black()) state = State::blackened;
        Darkness seen;
        Instant looked_at{}, ends_at = Instant::max();
        for (;; std::this_thread::sleep_for(kPoll)) {
            if (stop.stop_requested()) {
                ends_at = std::min(ends_at, clock.now() + kLongestEnd);
                if (clock.now() >= ends_at || (seen.from == dark_from && seen.judged())) return;
            }
            if (!due(seen, looked_at)) continue;
            const Instant::rep from = dark_from;
            if (seen.from != from) seen = {from};
            looked_at = clock.now();
            forgive_errors_on(display);  // others set a handler of theirs
            const auto output = projector_output(display, monitor);
            const std::optional<bool> lit = output ? is_lit(display, *output) : std::nullopt;
            if (!lit || dark_from != from) continue;  // not known; or a picture may have come meanwhile
            seen.lit_looks = *lit ? seen.lit_looks + 1 : 0;
            seen.dark_looks = *lit ? 0 : seen.dark_looks + 1;
            if (*lit && (seen.lit_looks >= kLooks || gamma.black()))
                state = gamma.blacken(*output) ? State::blackened : State::lit;
            if (!*lit && gamma.black() && seen.dark_looks >= kLooks) gamma.restore();
            if (!*lit && !gamma.black()) state = State::as_it_should;
        }
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
