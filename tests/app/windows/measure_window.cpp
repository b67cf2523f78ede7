// What the operator window costs on this machine: `measure_window [WIDTH HEIGHT [SECONDS]]`, on a display of its own
//   LIBGL_ALWAYS_SOFTWARE=1 xvfb-run -s "-screen 0 1920x1080x24" build/tests/app/windows/measure_window
// prints as JSON the share of a core while nothing changes, and the frames a second while both cameras (1920 x 1200)
// and all figures are new fifty times a second, with the loop of a session.
#include <fmt/format.h>

#include <chrono>
#include <cstdlib>

#include "app/live/window_meter.h"
#include "app/windows/operator_window.h"
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
    OperatorWindow window({"Planlight measures", width, height, std::nullopt, true, {}});
    for (int i = 0; i < 30; ++i) window.frame(model);
    WindowMeter meter;
    const auto run = [&](WindowMeter::Phase phase, const auto& change) {
        const auto began = steady_clock::now();
        for (double at_s = 0; at_s < seconds;) {
            at_s = std::chrono::duration<double>(steady_clock::now() - began).count();
            change(static_cast<std::size_t>(50 * at_s));
            const auto frame_began = steady_clock::now();
            window.frame(model);
            window.rest(rest_after(steady_clock::now() - frame_began));
            meter.note(phase, window.frames_drawn());
        }
    };
    run(WindowMeter::Phase::idle, [](std::size_t) {});
    const std::vector<SeenPicture> pictures = moving_pictures();
    run(WindowMeter::Phase::following, [&](std::size_t update) {
        model.left.live = pictures[update % pictures.size()];
        model.right.live = pictures[(update + 3) % pictures.size()];
        model.figures.overlay_error_mm = 0.1 * static_cast<double>(update % 9);
        model.figures.head_moved_mm = 0.1 * static_cast<double>(update % 37);
    });
    fmt::print("{}\n", meter.json());
}
