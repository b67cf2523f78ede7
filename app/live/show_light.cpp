#include "app/live/show_light.h"

#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <thread>

#include "app/console.h"
#include "app/live/light_source.h"
#include "planning_io/case/light_file.h"
#include "planning_io/files/make_folder.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"
#include "planning_io/types/steady_clock.h"
#include "projection/monitor/projector_window.h"

namespace planlight {
namespace {

/// Passes time as cameras of that frame rate would, and keeps the window alive meanwhile. Its frames are empty.
class Pace final : public StereoCamera {
public:
    Pace(ProjectorWindow& window, const Clock& clock, double frames_hz)
        : window_(window), clock_(clock), interval_(from_seconds(1 / frames_hz)) {}

    void wait_until(Instant at) {
        do {
            if (asked_to_end())
                throw DeviceError("Projector window", "the showing was ended", "Start it again for a whole recording.");
            window_.refresh();
            std::this_thread::sleep_for(
                std::clamp(at - clock_.now(), Instant{}, Instant(std::chrono::milliseconds(5))));
        } while (clock_.now() < at);
    }
    StereoFrame grab(Instant not_before, std::chrono::milliseconds) override {
        wait_until(std::max(not_before, last_ + interval_));
        last_ = clock_.now();
        StereoFrame frame;
        frame.at = last_;
        frame.number = ++number_;
        return frame;
    }

private:
    ProjectorWindow& window_;
    const Clock& clock_;
    Instant interval_, last_{};
    std::uint64_t number_ = 0;
};

}  // namespace

int show_light(const ProjectorOptions& options) {
    if (options.monitor.empty() || options.keep.empty())
        throw Error(ExitCode::usage, "showing needs the projector's monitor and a folder for the orders",
                    "Give --monitor NAME and --keep FOLDER.");
    note_end_signals();
    const SteadyClock clock;
    ProjectorWindowSettings settings;
    if (options.configured_delay_ms >= 0) settings.light_delay = from_seconds(options.configured_delay_ms / 1e3);
    ProjectorWindow window(options.monitor, clock, false, settings);
    Pace pace(window, clock, options.frames_hz);
    print_to_user("Nobody may lie under the projector. Let the cameras run until it is dark; Ctrl-C ends it.\n");
    ProgressBar bar;
    make_folder(options.keep);
    for (const std::string part : kLightParts) {
        if (options.part != "all" && options.part != part) continue;
        RecordSettings record;
        record.seed = options.seed;
        const LightBench bench{
            window, pace, clock, [&](Instant at) { pace.wait_until(at); }, [&](double share) { bar.show(part, share); },
            {}};
        const LightRecording shown = record_part(part, bench, record, {});
        write_folder_safely(options.keep / part, false, [&](const std::filesystem::path& into) {
            write_light_file({shown.settle, shown.orders, {}}, into);
        });
    }
    fmt::print(
        "{}: the orders of what was shown, on CLOCK_MONOTONIC. Add the frames of the same time to each light.json, and "
        "their pictures.\n",
        options.keep.string());
    return 0;
}

}  // namespace planlight
