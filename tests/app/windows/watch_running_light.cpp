// Whether light is ever older than it may be while all goes well, in the pixels of the monitor. Run by two_monitors.sh
// on an X server with two monitors: `watch_running_light FOLDER`, with PLANLIGHT the program (for its projector
// process) and ROUNDS how often the poses end (default 20). Pictures come thirty times a second, each as long valid as
// the session says, until no pose is good any more; meanwhile another thread looks at the screen all the time and knows
// by its colour which picture it sees. It says how long after the last good pose it was dark, and how many looks met a
// picture older than 75 ms; exit code 0 when none was older than 150 ms: a machine of tests has other work, too.
#include <fmt/format.h>
#include <sched.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdlib>
#include <random>
#include <thread>
#include <utility>
#include <vector>

#include "planning_io/types/error.h"
#include "projection/monitor/projector_process.h"
#include "projection/monitor/realtime_priority.h"
#include "projection/overlay_loop.h"
#include "projection/picture_validity.h"
#include "root_window.h"
#include "screen_pixel.h"

namespace {

using namespace planlight;
using test::expect;
using namespace std::chrono_literals;

constexpr Instant kWanted = 75ms, kLongest = 150ms;
constexpr Instant kPeriod = 33ms;

/// When each of the last pictures was handed over, by its grey.
class Handed {
public:
    static constexpr unsigned kGreys = 200;  ///< from 20 on; pictures of one grey lie 6 s apart at least
    void note(unsigned grey, Instant at) { at_ns_.at(grey) = at.count(); }
    Instant at(unsigned grey) const { return Instant(at_ns_.at(grey)); }
    void note_seen(unsigned grey, Instant at) { seen_ns_.at(grey) = at.count(); }
    bool was_seen(unsigned grey) const { return seen_ns_.at(grey) >= at_ns_.at(grey); }

private:
    std::array<std::atomic<Instant::rep>, 256> at_ns_{}, seen_ns_{};
};

/// Looks all the time, before all that other programs compute where it may: one that waited for a processor would find
/// darkness late.
struct Watched {
    std::atomic<long> looks{0}, of_light{0}, late{0}, stale{0}, strange{0};
    std::atomic<Instant::rep> oldest_ns{0};
    std::atomic<Instant::rep> dark_ns{0};  ///< when it was last found dark after light
};

void watch(const Monitor& monitor, Handed& handed, Watched& watched, const std::stop_token& stop) {
    const test::ScreenPixel eye(monitor);
    const SteadyClock clock;
    request_realtime_priority();
    for (bool lit = false; !stop.stop_requested(); std::this_thread::sleep_for(200us)) {
        const Instant looked = clock.now();  // what is seen was there at this moment or later
        const unsigned colour = eye.colour();
        ++watched.looks;
        if (std::exchange(lit, colour != 0) && !lit) watched.dark_ns = clock.now().count();
        if (!lit) continue;
        ++watched.of_light;
        const unsigned grey = colour & 0xFF;
        if (colour != grey * 0x010101 || handed.at(grey) == Instant{}) {
            ++watched.strange;
            continue;
        }
        handed.note_seen(grey, looked);
        const Instant age = looked - handed.at(grey);
        watched.late += age > kWanted;
        watched.stale += age > kLongest;
        watched.oldest_ns = std::max<Instant::rep>(watched.oldest_ns, age.count());
    }
}

void run(const Monitor& monitor, int rounds) {
    ProjectorProcessSettings settings;
    settings.program = std::getenv("PLANLIGHT");
    ProjectorProcess projector(monitor.name, settings);
    expect(!may_have_realtime_priority() || sched_getscheduler(projector.process()) == SCHED_RR,
           "the projector process goes before all that other programs compute, where it may");
    const Instant validity = picture_validity(OverlaySettings{}.picture_validity, kPeriod);
    const std::jthread keeper([&](const std::stop_token& stop) {  // as a session does: none of this is at fault
        for (; !stop.stop_requested(); std::this_thread::sleep_for(4ms)) projector.check(), projector.renew();
    });
    projector.renew();
    Handed handed;
    Watched watched;
    std::jthread watcher([&](const std::stop_token& stop) { watch(monitor, handed, watched, stop); });
    const test::ScreenPixel eye(monitor);
    const SteadyClock clock;
    std::minstd_rand random(1);
    std::uniform_int_distribution<int> few(1, 8), early_ms(0, 8);
    std::vector<Instant> times;
    int never = 0, unlit = 0;
    unsigned number = 0;
    for (int round = 0; round < rounds; ++round) {
        Instant last{};
        unsigned last_grey = 0;
        const int pictures = few(random);
        for (int i = 0; i < pictures; ++i) {
            const unsigned grey = 20 + number++ % Handed::kGreys;
            const auto g = static_cast<std::uint8_t>(grey);
            const RgbImage picture(projector.width(), projector.height(), {g, g, g});
            last = clock.now();
            handed.note(grey, last);
            last_grey = grey;
            projector.show(picture, last + validity);
            if (i + 1 < pictures)
                std::this_thread::sleep_until(std::chrono::steady_clock::time_point(last + kPeriod) -
                                              std::chrono::milliseconds(early_ms(random)));
        }
        const bool dark = eye.until_dark(2s).has_value();
        // The watcher may be a moment behind.
        for (int i = 0; dark && i < 2000 && Instant(watched.dark_ns) <= last; ++i) std::this_thread::sleep_for(1ms);
        unlit += !handed.was_seen(last_grey);  // asked of the watcher: this thread may wait for a processor too long
        if (dark && Instant(watched.dark_ns) > last)
            times.push_back(Instant(watched.dark_ns) - last);
        else
            ++never;
    }
    watcher = {};
    std::sort(times.begin(), times.end());
    if (times.empty()) times.push_back(2s);
    const auto ms = [](Instant t) { return 1e3 * seconds(t); };
    expect(unlit == 0, fmt::format("{} pictures handed over were lit, {} were not", number, unlit));
    expect(never == 0 && times.back() <= kLongest,
           fmt::format("dark {:.0f} ms (median), {:.0f} ms (worst of {}) after the last good pose, never {} times",
                       ms(times[times.size() / 2]), ms(times.back()), rounds, never));
    expect(watched.stale == 0 && watched.strange == 0 && watched.of_light > 0,
           fmt::format("of {} looks, {} at light: {} at a picture older than {:.0f} ms, {} at none of ours; the oldest "
                       "was {:.0f} ms old",
                       watched.looks.load(), watched.of_light.load(), watched.late.load(), ms(kWanted),
                       watched.strange.load(), ms(Instant(watched.oldest_ns))));
}

}  // namespace

int main() {
    const std::vector<Monitor> monitors = list_monitors();
    if (std::getenv("PLANLIGHT") == nullptr || monitors.size() != 2) return 2;
    const char* const rounds = std::getenv("ROUNDS");
    run(monitors[1], rounds == nullptr ? 20 : std::atoi(rounds));
    return test::failures() == 0 ? 0 : 1;
}
