// A projector that is lost on an ordinary desktop, which is not black: its picture must not lie on the patient instead.
// Run by two_monitors.sh: `keep_projector FOLDER`, with PLANLIGHT the program (for its projector process). The desktop
// is made white; then the projector process is killed, another window lies before the light, the monitor is turned, and
// the operator's monitor is taken away. With the compositor picom as MANAGER, of the process MANAGER_PROCESS, that is
// made to hang as well, while the light is on. Exit code 0 when nothing white was seen for longer than 200 ms
// (through the compositor 300).
#include <X11/Xlib.h>
#include <fmt/format.h>

#include <csignal>
#include <cstdlib>
#include <thread>

#include "app/live/projector_keeper.h"
#include "desktop_picture.h"
#include "planning_io/types/error.h"
#include "planning_io/types/steady_clock.h"
#include "projection/monitor/projector_output.h"
#include "projection/monitor/projector_window.h"
#include "projection/monitor/x11_pointers.h"
#include "root_window.h"
#include "screen_pixel.h"

namespace {

using namespace planlight;
using namespace std::chrono_literals;
using test::expect;

constexpr unsigned kWhite = 0xFFFFFF, kGreen = 0x00FF00;

bool run(const char* command) {
    return std::system(command) == 0;
}

/// What of the desktop, or of another window, was seen in a while.
struct Seen {
    Instant longest_white{};
    unsigned last = 0;
};

Seen watch(const test::ScreenPixel& eye, Instant duration) {
    const SteadyClock clock;
    Seen seen;
    const Instant until = clock.now() + duration;
    Instant white_since = Instant::max();
    for (Instant now = clock.now(); now < until; now = clock.now()) {
        seen.last = eye.colour();
        white_since = seen.last == kWhite ? std::min(white_since, now) : Instant::max();
        if (seen.last == kWhite) seen.longest_white = std::max(seen.longest_white, clock.now() - white_since);
        std::this_thread::sleep_for(1ms);
    }
    return seen;
}

/// Above all others, as a notification is.
class OtherWindow {
public:
    explicit OtherWindow(const Monitor& monitor, bool stubborn = false) : display_(XOpenDisplay(nullptr)) {
        XSetWindowAttributes wanted{};
        wanted.override_redirect = True;
        wanted.background_pixel = WhitePixel(display_, DefaultScreen(display_));
        const ::Window window =
            XCreateWindow(display_, DefaultRootWindow(display_), monitor.x + monitor.width / 2 - 100,
                          monitor.y + monitor.height / 2 - 50, 200, 100, 0, CopyFromParent, InputOutput, nullptr,
                          CWOverrideRedirect | CWBackPixel, &wanted);
        XMapRaised(display_, window);
        XSync(display_, False);
        if (!stubborn) return;
        // Above whatever of the projector's comes, but not for ever: what covers it is to stay.
        stays_ = std::jthread([this, window](const std::stop_token& stop) {
            for (int i = 0; i < 100 && !stop.stop_requested(); ++i, std::this_thread::sleep_for(5ms)) {
                XRaiseWindow(display_, window);
                XSync(display_, False);
            }
        });
    }
    ~OtherWindow() {
        if (stays_.joinable()) stays_.request_stop(), stays_.join();
        XCloseDisplay(display_);
    }
    OtherWindow(const OtherWindow&) = delete;
    OtherWindow& operator=(const OtherWindow&) = delete;

private:
    Display* display_;
    std::jthread stays_;
};

class Kept {
public:
    Kept() {
        ProjectorKeeperSettings settings;
        settings.process.program = std::getenv("PLANLIGHT");
        keeper_ = std::make_unique<ProjectorKeeper>("DUMMY1", settings);
        beats_ = std::jthread([this](const std::stop_token& stop) {
            for (; !stop.stop_requested(); std::this_thread::sleep_for(20ms)) {
                keeper_->window_lives();
                keeper_->session_lives(clock_.now());
            }
        });
    }
    ProjectorKeeper& keeper() { return *keeper_; }
    /// As soon as it is there; false when that takes too long.
    bool light() {
        for (const Instant until = clock_.now() + 10s; clock_.now() < until; std::this_thread::sleep_for(20ms)) try {
                keeper_->show(RgbImage(keeper_->width(), keeper_->height(), {0, 255, 0}), clock_.now() + 60s);
                return true;
            } catch (const DeviceError&) {
            }
        return false;
    }
    std::string problem_within(Instant patience) {
        for (const Instant until = clock_.now() + patience; clock_.now() < until; std::this_thread::sleep_for(1ms))
            if (const std::string what = keeper_->problem().what; !what.empty()) return what;
        return {};
    }

private:
    SteadyClock clock_;
    std::unique_ptr<ProjectorKeeper> keeper_;
    std::jthread beats_;
};

/// How long until `fact`; five seconds where it does not come.
template <class Fact>
Instant time_until(const Fact& fact) {
    const SteadyClock clock;
    const Instant start = clock.now();
    while (!fact() && clock.now() - start < 5s) std::this_thread::sleep_for(2ms);
    return clock.now() - start;
}

bool composited() {
    return std::string(std::getenv("MANAGER")) == "picom";
}

void expect_hidden(const Seen& seen, const std::string& what) {
    expect(seen.longest_white <= (composited() ? 300ms : 200ms),
           fmt::format("{}: white was seen for {:.0f} ms at the longest", what, 1e3 * seconds(seen.longest_white)));
}

void lose_it(const Monitor& operators, const Monitor& projectors) {
    const test::ScreenPixel eye(projectors);
    expect(eye.shows_soon(kWhite), "the desktop is white on the projector's monitor");
    Kept kept;
    expect(eye.shows_soon(0), "black, as soon as it is open");
    expect(kept.light() && eye.shows_soon(kGreen), "and lit");

    kept.keeper().disturb(SIGKILL);
    const Seen killed = watch(eye, 4s);
    expect_hidden(killed, "its process is killed");
    expect(killed.last == 0 && kept.keeper().starts() == 2, "dark, and started again");
    expect(kept.light() && eye.shows_soon(kGreen), "lit again, with nothing before it");

    {
        const OtherWindow other(projectors);
        const Seen seen = watch(eye, 2s);
        expect_hidden(seen, "another window comes before it");
    }
    expect(kept.light() && eye.shows_soon(kGreen), "lit, or lit again");
    {
        const OtherWindow other(projectors, true);
        const std::string problem = kept.problem_within(2s);
        expect(problem.find("another window") != std::string::npos, "one that stays there is noticed: " + problem);
        watch(eye, 600ms);  // it gives up, sooner or later
        expect(time_until([&] { return eye.colour() != kWhite; }) < 1500ms, "and covered");
    }
    expect(kept.light() && eye.shows_soon(kGreen), "lit again once that is gone");

    const std::string turn = "xrandr --output " + projectors.name + " --scale 2x2 2>/dev/null";
    if (run(turn.c_str())) {
        const std::string problem = kept.problem_within(1s);
        expect(!problem.empty(), "a monitor that was scaled is noticed: " + problem);
        expect(run(("xrandr --output " + projectors.name + " --scale 1x1").c_str()) && kept.light(), "and back");
    } else {
        fmt::print("     (this X server turns and scales no monitor)\n");
    }

    const std::string off =
        fmt::format("xrandr --fb {}x1080 --output {} --off --output {} --pos {}x{}", projectors.x + projectors.width,
                    operators.name, projectors.name, projectors.x, projectors.y);
    expect(run(off.c_str()), "(the operator's monitor is taken away)");
    const std::string alone = kept.problem_within(2s);
    expect(!alone.empty(), "light that nobody watches over goes out: " + alone);
}

/// By the tables of the monitor's graphics output.
bool black_by_gamma(const Monitor& monitor) {
    const X11Display display(XOpenDisplay(nullptr));
    const auto output = projector_output(display.get(), monitor.name);
    if (!output) return false;
    const X11Pointer<XRRScreenResources, XRRFreeScreenResources> resources(
        XRRGetScreenResourcesCurrent(display.get(), DefaultRootWindow(display.get())));
    const X11Pointer<XRROutputInfo, XRRFreeOutputInfo> info(
        XRRGetOutputInfo(display.get(), resources.get(), output->outputs.at(0)));
    const X11Pointer<XRRCrtcGamma, XRRFreeGamma> gamma(XRRGetCrtcGamma(display.get(), info->crtc));
    const auto last = static_cast<std::size_t>(gamma->size) - 1;
    return gamma->red[last] == 0 && gamma->green[last] == 0 && gamma->blue[last] == 0;
}

/// What it drew last stays on the monitor, whatever the windows show.
void hang_compositor(pid_t compositor, const Monitor& projectors) {
    const test::ScreenPixel eye(projectors);
    Kept kept;
    expect(kept.light() && eye.shows_soon(kGreen) && !black_by_gamma(projectors), "lit, through a compositor");
    kill(compositor, SIGSTOP);
    kept.keeper().go_dark();
    const Instant dark = time_until([&] { return black_by_gamma(projectors); });
    expect(dark <= 400ms, fmt::format("the compositor hangs: black by gamma {:.0f} ms after the light was to go",
                                      1e3 * seconds(dark)));
    const std::string problem = kept.problem_within(1s);
    expect(problem.find("still shows something") != std::string::npos, "and said: " + problem);
    expect(kept.keeper().problem().may_be_lit, "whether the output obeys nobody can tell: the lens is to be looked at");
    expect(run(("xrandr --output " + projectors.name + " --gamma 1:1:1").c_str()) &&
               time_until([&] { return black_by_gamma(projectors); }) < 500ms,
           "also where another program sets a gamma of its own");
    watch(eye, 2s);
    expect(black_by_gamma(projectors) && kept.keeper().starts() == 1, "and stays so while it hangs");
    kill(compositor, SIGCONT);
    const Instant back = time_until([&] { return !black_by_gamma(projectors); });
    expect(back < 2s && !eye.lit(), "it goes on: what is beneath is black, and the gamma as it was");
    expect(kept.light() && eye.shows_soon(kGreen), "lit again");
    kept.keeper().go_dark();
    expect(!watch(eye, 700ms).last && kept.keeper().problem().empty(), "dark as usual");
}

void end_while_compositor_hangs(pid_t compositor, const Monitor& projectors) {
    {
        Kept kept;
        expect(kept.light() && test::ScreenPixel(projectors).shows_soon(kGreen), "lit once more");
        kill(compositor, SIGSTOP);
    }
    expect(black_by_gamma(projectors), "the session ends while it hangs: the monitor stays black");
    Kept next;
    watch(test::ScreenPixel(projectors), 1s);
    expect(black_by_gamma(projectors) && !next.keeper().problem().empty(), "the next one leaves it so, and says why");
    kill(compositor, SIGCONT);
    expect(time_until([&] { return !black_by_gamma(projectors); }) < 2s && next.light(),
           "and gives its gamma back once it goes on");
}

}  // namespace

int main() {
    const test::DesktopPicture desktop(kWhite);
    try {
        const auto monitors = list_monitors();
        if (composited())
            for (const auto& test : {hang_compositor, end_while_compositor_hangs})
                test(std::atoi(std::getenv("MANAGER_PROCESS")), monitors.at(1));
        lose_it(monitors.at(0), monitors.at(1));
    } catch (const Error& error) {
        expect(false, std::string("thrown: ") + error.what() + "; " + error.remedy);
    }
    return test::failures() == 0 ? 0 : 1;
}
