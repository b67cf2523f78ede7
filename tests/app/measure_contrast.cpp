// Is the light seen under the lamps of a theatre? Plans on the example patient in simulated rooms, each in a random
// pose, under rising room light: how much brighter than the skin beside them the cameras see the lines of each kind,
// what share of the light CHECK sees, and how many labels tesseract reads. The camera is exposed anew for each, as one
// would. measure_contrast [POSES [FIRST_SEED [PROJECTOR_LUX [paper|modern]]]]   (default 3 poses, seed 1, both presets)
// PROJECTOR_LUX: of white on the field, 5000 where it is not given (800 lumens over 40 cm x 40 cm).
#include <fmt/format.h>

#include <cstdlib>
#include <string>

#include "planning_io/types/statistics.h"
#include "tests/app/labelled_head.h"
#include "tests/app/read_labels.h"
#include "tests/support/test_data.h"

namespace planlight::test {
namespace {

/// White light and lamps together make skin this bright in the simulated room, whatever the share of either.
constexpr double kBrightSkin = 165.0 / 255;

void print(double lux, const LabelsRead& read) {
    static const std::map<StrokeKind, const char*> kNames{{StrokeKind::osteotomy_line, "lines"},
                                                          {StrokeKind::borehole, "boreholes"},
                                                          {StrokeKind::trajectory, "trajectories"},
                                                          {StrokeKind::cut_plane, "planes"},
                                                          {StrokeKind::tick, "ticks"}};
    fmt::print("  {:>5.0f} lux:", lux);
    for (const auto& [kind, values] : read.contrast)
        if (kNames.contains(kind) && values.size() >= 5)
            fmt::print(" {} {:.2f} (5 % below {:.2f}, {} places);", kNames.at(kind), quantile(values, 0.5),
                       quantile(values, 0.05), values.size());
    fmt::print(" CHECK sees {} of {} stretches and says {:.2f}; {} of {} labels read right, {} as another number\n",
               read.check_seen, read.check_expected, quantile(read.check_brighter, 0.5), read.right, read.lit,
               read.other_number.size());
    std::fflush(stdout);
}

int run(int poses, unsigned first_seed, double projector_lux, const std::string& preset) {
    if (!example_patient()) {
        fmt::print("the package invesalius-examples is needed\n");
        return 1;
    }
    const LabelledHead head;
    for (const auto each : {simulation::Preset::paper, simulation::Preset::modern}) {
        const std::string name = each == simulation::Preset::paper ? "paper" : "modern";
        if (!preset.empty() && preset != name) continue;
        fmt::print(
            "{} room, {} poses, projector {:.0f} lux; brighter than the skin beside it by (1 = twice as bright)\n",
            name, poses, projector_lux);
        for (const double lux : {100., 500., 1000., 2000., 4000.}) {
            LabelsRead all;
            for (int i = 0; i < poses; ++i)
                all.append(head.read(each, first_seed + static_cast<unsigned>(i), false,
                                     kBrightSkin * lux / (lux + projector_lux)));
            print(lux, all);
        }
    }
    return 0;
}

}  // namespace
}  // namespace planlight::test

int main(int argc, char** argv) {
    return planlight::test::run(argc > 1 ? std::atoi(argv[1]) : 3,
                                argc > 2 ? static_cast<unsigned>(std::atoi(argv[2])) : 1,
                                argc > 3 ? std::atof(argv[3]) : 5000, argc > 4 ? argv[4] : "");
}
