// What the operator window costs on this machine: `measure_window [WIDTH HEIGHT [SECONDS]]`, on a display of its own
//   LIBGL_ALWAYS_SOFTWARE=1 xvfb-run -s "-screen 0 1920x1080x24" build/tests/app/windows/measure_window
// prints as JSON the share of a core while nothing changes, the frames a second while both cameras (1920 x 1200) and
// all figures are new fifty times a second, with the loop of a session, and how long after a press of DARK's key, while
// that goes on, the banner on the screen says so.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <future>

#include "app/live/window_meter.h"
#include "app/windows/operator_window.h"
#include "dark_key.h"
#include "fake_model.h"

namespace {

using namespace planlight;
using std::chrono::steady_clock;

/// Pictures of both cameras that differ, with what was found in them.
std::vector<SeenPicture> moving_pictures() {
    std::vector<SeenPicture> pictures;
    for (int i = 0; i < 8; ++i) {
        GrayImage picture(1920, 1200, 20);
        for (int y = 300; y < 900; ++y)
            for (int x = 500 + 20 * i; x < 1200 + 20 * i; ++x)
                picture.at(x, y) = static_cast<std::uint8_t>(60 + (x * 7 + y * 13) % 120);
        SeenPicture seen{std::make_shared<GrayImage>(std::move(picture)), {}, true};
        for (int k = 0; k < 6; ++k) seen.found.push_back({{600 + 20 * i + 90 * k, 500}, 14});
        pictures.push_back(std::move(seen));
    }
    return pictures;
}

}  // namespace

int main(int argc, char** argv) {
    const int width = argc > 2 ? std::atoi(argv[1]) : 1920, height = argc > 2 ? std::atoi(argv[2]) : 1080;
    const double seconds = argc > 3 ? std::atof(argv[3]) : 10;
    OperatorModel model = test::fake_model();
    std::atomic<bool> asked_dark{false};
    const Status aligned{StatusKind::aligned, "The plan is on the skin.", {}, {}};
    const Status dark_status{StatusKind::dark, "DARK was pressed. There is no light on the patient.", {}, {}};
    model.status = aligned;
    constexpr const char* kTitle = "Planlight measures";
    OperatorWindow window({kTitle, width, height, std::nullopt, true, {}});
    for (int i = 0; i < 30; ++i) window.frame(model);
    WindowMeter meter;
    const auto loop = [&](WindowMeter::Phase phase, const auto& goes_on, const auto& change) {
        const auto began = steady_clock::now();
        while (goes_on(steady_clock::now() - began)) {
            const double at_s = std::chrono::duration<double>(steady_clock::now() - began).count();
            change(static_cast<std::size_t>(50 * at_s));
            const auto frame_began = steady_clock::now();
            const OperatorAction action = window.frame(model);
            if (action == OperatorAction::dark) {
                asked_dark = true;  // as a session is dark before it draws
                continue;
            }
            window.rest(rest_after(steady_clock::now() - frame_began));
            meter.note(phase, window.frames_drawn());
        }
    };
    const auto for_seconds = [&](auto since) { return std::chrono::duration<double>(since).count() < seconds; };
    loop(WindowMeter::Phase::idle, for_seconds, [](std::size_t) {});
    const std::vector<SeenPicture> pictures = moving_pictures();
    const auto follow = [&](std::size_t update) {
        model.left.live = pictures[update % pictures.size()];
        model.right.live = pictures[(update + 3) % pictures.size()];
        model.figures.overlay_error_mm = 0.1 * static_cast<double>(update % 9);
        model.figures.head_moved_mm = 0.1 * static_cast<double>(update % 37);
        model.status = asked_dark ? dark_status : aligned;
    };
    loop(WindowMeter::Phase::following, for_seconds, follow);
    const std::string of_window = meter.json();

    constexpr int kPresses = 50, kFromEdge = 40;
    auto person = std::async(std::launch::async, [&] {
        return test::dark_key_to_banner_ms(kTitle, width / 2, height - kFromEdge, kPresses, asked_dark);
    });
    loop(
        WindowMeter::Phase::following,
        [&](auto) { return person.wait_for(std::chrono::seconds(0)) != std::future_status::ready; }, follow);
    std::vector<double> ms = person.get();
    std::ranges::sort(ms);
    fmt::print(
        R"({{"window": {}, "dark_to_banner_ms": {{"presses": {}, "median": {:.0f}, "p95": {:.0f}, "worst": {:.0f}}}}})"
        "\n",
        of_window, ms.size(), ms[ms.size() / 2], ms[ms.size() * 95 / 100], ms.back());
}
