// measure_guided paper|modern FIRST_SEED ROOMS: guided calibrations in simulated rooms, without a wire, of a board that
// a person carries about with mistakes: poses, time by the room's clock, what was refused, and the rig against the
// truth.
#include <fmt/format.h>

#include "planning_io/types/statistics.h"
#include "tests/app/guided_room.h"

int main(int argc, char** argv) {
    using namespace planlight;
    if (argc < 4) {
        fmt::print("measure_guided paper|modern FIRST_SEED ROOMS\n");
        return 2;
    }
    std::setvbuf(stdout, nullptr, _IOLBF, 0);
    const auto preset = std::string(argv[1]) == "paper" ? simulation::Preset::paper : simulation::Preset::modern;
    std::vector<double> points, light, took, poses;
    int refused = 0;
    for (int i = 0; i < std::stoi(argv[3]); ++i) {
        const auto seed = static_cast<unsigned>(std::stoi(argv[2]) + i);
        const test::GuidedRoom room = test::guide_in_room(preset, seed);
        std::string why;
        for (const auto& [reason, count] : room.refused) why += fmt::format(" {} {};", count, reason);
        if (room.calibration.refusal) {
            ++refused;
            fmt::print("seed {}: refused: {}; sent on:{}\n", seed, room.calibration.refusal->reason, why);
            continue;
        }
        points.push_back(quantile(room.error.points_mm, 0.95));
        light.push_back(quantile(room.error.light_mm, 0.95));
        took.push_back(room.took_s);
        poses.push_back(static_cast<double>(room.poses));
        fmt::print(
            "seed {}: {} poses in {:.0f} s; predicted {:.4f} mm; true 95 %: points {:.4f} mm, light {:.4f} mm; sent "
            "on:{}\n",
            seed, room.poses, room.took_s, room.predicted_mm.value_or(0), points.back(), light.back(), why);
    }
    if (points.empty()) return 1;
    fmt::print(
        "{} rooms, {} refused; median / worst: poses {:.0f} / {:.0f}, time {:.0f} / {:.0f} s, points {:.4f} / {:.4f} "
        "mm, light {:.4f} / {:.4f} mm (95 % of the volume)\n",
        points.size(), refused, median(poses), quantile(poses, 1), median(took), quantile(took, 1), median(points),
        quantile(points, 1), median(light), quantile(light, 1));
}
