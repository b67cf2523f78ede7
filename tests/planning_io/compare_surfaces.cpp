#include <fmt/format.h>

#include <cstdlib>

#include "planning_io/types/error.h"
#include "planning_io/volume/read_volume.h"
#include "tests/planning_io/surface_distance.h"

/// compare_surfaces VOLUME VOLUME [LEVEL]: how far the iso-surfaces of two volumes of one frame are apart (default 200
/// HU), mm.
int main(int argc, char** argv) {
    if (argc < 3) return fmt::print("compare_surfaces VOLUME VOLUME [LEVEL]\n"), 2;
    const double level = argc > 3 ? std::atof(argv[3]) : 200;
    try {
        const auto a = planlight::read_volume(argv[1]), b = planlight::read_volume(argv[2]);
        if (a.frame_of_reference_uid != b.frame_of_reference_uid)
            fmt::print("the two are not in one frame of reference\n");
        for (const bool back : {false, true}) {
            const auto d =
                back ? planlight::test::surface_distance(b, a, level) : planlight::test::surface_distance(a, b, level);
            fmt::print("{} at {}: median {:.2f} mm, 90 % {:.2f} mm, of {} points\n",
                       back ? "second to first" : "first to second", level, d.median_mm, d.p90_mm, d.points);
        }
    } catch (const planlight::Error& e) {
        return fmt::print("{}. {}\n", e.what(), e.remedy), static_cast<int>(e.exit_code);
    }
    return 0;
}
