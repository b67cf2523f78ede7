// Run by two_monitors.sh on an X server with two monitors: every monitor shows its own name, and is dark after that.
// Argument: folder for the pictures. Exit code 0 when all holds.
#include <filesystem>
#include <thread>

#include "planning_io/types/error.h"
#include "planning_io/types/steady_clock.h"
#include "projection/monitor/monitor_card.h"
#include "root_window.h"

namespace {

using namespace planlight;
using test::different;
using test::expect;
using test::screen;

void run(const std::string& folder) {
    const SteadyClock clock;
    const std::vector<Monitor> monitors = list_monitors();
    expect(monitors.size() == 2, "two monitors");
    expect(monitors.at(0).refresh_hz > 20 && monitors.at(1).refresh_hz > 20, "their refresh rates are known");
    int looked = 0;
    const auto look = [&] {
        if (++looked != 10) return false;
        const RgbImage root = screen(folder, "1_cards");
        for (std::size_t i = 0; i < 2; ++i)
            expect(different(root, monitors[i], draw_monitor_card(monitors[i], static_cast<int>(i))) == 0,
                   monitors[i].name + " shows its own card, pixel by pixel");
        return true;
    };
    expect(show_monitor_cards(clock, 30, look).empty(), "no monitor is left out");
    const Instant began = clock.now();
    RgbImage after_the_end;
    bool taken = false;
    // As if the program hung: the pictures expire while nothing calls the windows.
    show_monitor_cards(clock, 1, [&] {
        if (taken) return true;
        taken = true;
        std::this_thread::sleep_for(std::chrono::milliseconds(1500));
        after_the_end = screen(folder, "2_expired");
        return true;
    });
    for (const Monitor& monitor : monitors)
        expect(different(after_the_end, monitor, RgbImage(monitor.width, monitor.height)) == 0,
               monitor.name + " is black after the end");
    expect(clock.now() - began < std::chrono::seconds(15), "and all of it ends by itself");
}

}  // namespace

int main(int argc, char** argv) {
    const std::string folder = argc > 1 ? argv[1] : ".";
    std::filesystem::create_directories(folder);
    try {
        run(folder);
    } catch (const std::exception& error) {
        expect(false, std::string("thrown: ") + error.what());
    }
    return test::failures() == 0 ? 0 : 1;
}
