// Run by two_monitors.sh on an X server with two monitors: opens both windows, lights the second monitor, and at each
// step looks at the root window as a person would see it. Argument: folder for the pictures. Exit code 0 when all
// holds.
#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <new>
#include <string>
#include <thread>

#include "app/windows/operator_window.h"
#include "fake_model.h"
#include "keyboard_owner.h"
#include "planning_io/types/error.h"
#include "planning_io/types/steady_clock.h"
#include "projection/monitor/projector_window.h"
#include "projector_picture.h"
#include "root_window.h"

namespace {

using namespace planlight;
using test::different;
using test::expect;
using test::screen;
void expect_refusal(const std::string& what, const std::string& word, const std::function<void()>& act) {
    try {
        act();
        expect(false, what + " (nothing was thrown)");
    } catch (const DeviceError& error) {
        expect(std::string(error.what()).find(word) != std::string::npos && !error.remedy.empty(),
               what + ": " + error.what());
    }
}

/// Fails, once it is told to, for whoever reads it beside the main thread: the thread that owns the picture.
class FailingClock final : public Clock {
public:
    Instant now() const override {
        if (fails && std::this_thread::get_id() != main_) throw std::bad_alloc();
        return clock_.now();
    }
    std::atomic<bool> fails{false};

private:
    SteadyClock clock_;
    std::thread::id main_ = std::this_thread::get_id();
};

/// What owns the picture has ended of a fault: the light goes with it, and whoever looks after the window is told.
void fail_to_draw(const std::string& folder) {
    const Monitor second = list_monitors().at(1);
    const RgbImage black(second.width, second.height), picture = test::projector_picture(second.width, second.height);
    FailingClock clock;
    ProjectorWindow projector(second.name, clock);
    projector.refresh();
    projector.show(picture, clock.now() + std::chrono::seconds(60));
    expect(different(screen(folder, "a_before_the_fault"), second, picture) == 0, "lit before the fault");
    clock.fails = true;
    expect_refusal("a picture that nobody draws any more is noticed", "memory", [&] {
        for (int i = 0; i < 100; ++i) projector.refresh(), std::this_thread::sleep_for(std::chrono::milliseconds(20));
    });
    expect(projector.dark() && different(screen(folder, "b_after_the_fault"), second, black) == 0, "and it is dark");
    projector.go_dark();
    expect_refusal("darkness that nobody draws is not said to be done", "memory", [&] { projector.refresh(); });
}

void run(const std::string& folder) {
    using std::chrono::seconds;
    const std::vector<Monitor> monitors = list_monitors();
    expect(monitors.size() == 2, fmt::format("two monitors ({})", monitors.size()));
    const Monitor first = monitors.at(0), second = monitors.at(1);
    expect(first.primary && !second.primary, "the first is the primary one");
    const SteadyClock clock;
    expect_refusal("the primary monitor is refused", "primary", [&] { ProjectorWindow window(first.name, clock); });
    expect_refusal("an unknown monitor is refused by name", "HDMI-9", [&] { ProjectorWindow window("HDMI-9", clock); });

    const OperatorModel model = test::fake_model();
    OperatorWindow operator_window({"Planlight", 1280, 800, first.name, true});
    ProjectorWindow projector(second.name, clock);
    expect(projector.width() == second.width && projector.height() == second.height,
           "the projector has the monitor's size");
    const RgbImage black(second.width, second.height), picture = test::projector_picture(second.width, second.height);

    for (int i = 0; i < 3; ++i) operator_window.frame(model), projector.refresh();
    const RgbImage before = screen(folder, "1_before");
    const std::string keyboard = test::keyboard_owner();
    expect(keyboard != "Planlight projector",
           "the projector's window has not taken the keyboard (" + keyboard + " has it)");
    {
        const test::KeyboardTaken taken;
        expect(operator_window.keyboard_is_elsewhere(), "that no key reaches the operator window is known");
    }
    expect(different(before, second, black) == 0, "the second monitor is black at first");

    const Instant asked = clock.now(), lit = projector.show(picture, clock.now() + seconds(60));
    expect(lit >= asked + std::chrono::milliseconds(25),
           "the light is said to come 25 ms or more after it was asked for");
    const RgbImage shown = screen(folder, "2_shown");
    expect(different(shown, second, picture) == 0, "the second monitor shows the picture, pixel by pixel");
    RgbImage operator_before(first.width, first.height);
    for (int y = 0; y < first.height; ++y)
        for (int x = 0; x < first.width; ++x) operator_before.at(x, y) = before.at(first.x + x, first.y + y);
    expect(different(shown, first, operator_before) == 0, "the first monitor has not changed by one pixel");
    operator_window.frame(model);
    projector.refresh();
    expect(different(screen(folder, "3_operator_drew"), second, picture) == 0,
           "it stays while the operator window draws");

    projector.go_dark();
    expect(projector.dark() && different(screen(folder, "4_go_dark"), second, black) == 0, "go_dark is black");

    projector.show(picture, clock.now() + std::chrono::milliseconds(400));
    expect(!projector.dark(), "lit before the expiry");
    std::this_thread::sleep_for(std::chrono::milliseconds(450));  // no call into the window: as if the program hung
    expect(different(screen(folder, "5_expired"), second, black) == 0, "black after the expiry with no call at all");
    expect(projector.dark(), "and says so");
    projector.show(picture, clock.now() - seconds(1));
    expect(different(screen(folder, "6_stale"), second, black) == 0, "a picture that has expired already is not shown");

    projector.show(picture, clock.now() + seconds(60));
    expect_refusal("a picture of another size is refused", "fit", [&] {
        projector.show(RgbImage(800, 601, {255, 255, 255}), clock.now() + seconds(60));
    });
    expect(different(screen(folder, "7_wrong_size"), second, black) == 0, "and it is dark then");

    projector.show(picture, clock.now() + seconds(60));
    expect(std::system(("xrandr --output " + second.name + " --off").c_str()) == 0, "(monitor unplugged)");
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    expect_refusal("an unplugged monitor is noticed", second.name, [&] {
        for (int i = 0; i < 20; ++i) projector.refresh(), std::this_thread::sleep_for(std::chrono::milliseconds(20));
    });
    expect(projector.dark(), "and it is dark then");
    for (int i = 0; i < 3; ++i) operator_window.frame(model);  // the server gives the screen a new, unpainted memory
    const RgbImage after = screen(folder, "8_unplugged");
    expect(different(after, first, operator_before) == 0,
           "the operator's monitor still shows the operator window alone");
    expect_refusal("the only monitor is refused", "only", [&] { ProjectorWindow window("0", clock); });
}

}  // namespace

int main(int argc, char** argv) {
    const std::string folder = argc > 1 ? argv[1] : ".";
    std::filesystem::create_directories(folder);
    try {
        fail_to_draw(folder);
        run(folder);
    } catch (const Error& error) {
        expect(false, std::string("thrown: ") + error.what() + "; " + error.remedy);
    } catch (const std::exception& error) {
        expect(false, std::string("thrown: ") + error.what());
    }
    return test::failures() == 0 ? 0 : 1;
}
