// What the match says of heads that are twisted against their CT, by how many points the scan has: not a test, a
// measurement (registration/matching/ACCURACY.md).
// measure_twisted_heads SCANS [FIRST]: so many scans of each twist and number of points, from that seed on.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <numbers>
#include <vector>

#include "planning_io/types/statistics.h"
#include "registration/matching/register_patient.h"
#include "tests/registration/matching/ct_head_scene.h"
#include "tests/registration/matching/matching_scenes.h"

namespace {

using namespace planlight;
using namespace planlight::test;

struct Row {
    int yes = 0, ask = 0, no = 0, within = 0;
    std::vector<double> off_mm, of_yes_mm, bound_mm;  ///< light, 95 % of a scan's points; the bound at its middle

    void add(const RegistrationResult& found, double light_mm) {
        ++(found.verdict == Verdict::yes ? yes : found.verdict == Verdict::ask ? ask : no);
        if (found.verdict == Verdict::no) return;
        off_mm.push_back(light_mm);
        if (found.verdict == Verdict::yes) of_yes_mm.push_back(light_mm);
        bound_mm.push_back(predicted_error(found.covariance, found.covariance.centre_in_ct).bound_95_mm);
        within += light_mm <= bound_mm.back();
    }
};

Row measured(const CtHead& head, double degrees_per_100_mm, int points, unsigned first, unsigned scans) {
    Row row;
    for (unsigned i = first; i < first + scans; ++i) {
        const double by = (i % 2 == 0 ? 1 : -1) * degrees_per_100_mm / 100 * std::numbers::pi / 180;
        const PointCloud of_ct = ct_view(head, i, 190, points), there = moved(twisted(of_ct, by), random_pose(i + 160));
        const RegistrationResult found = register_patient(spoiled(there, 0.2, 0, i), head.lut);
        row.add(found, quantile(light_off_mm(found.patient_from_ct, of_ct, there), 0.95));
    }
    return row;
}

double worst(const std::vector<double>& values) {
    return values.empty() ? 0 : *std::max_element(values.begin(), values.end());
}

}  // namespace

int main(int argc, char** argv) {
    const int scans = argc > 1 ? std::atoi(argv[1]) : 0;
    if (scans < 1) return fmt::print(stderr, "measure_twisted_heads SCANS [FIRST]\n"), 2;
    const auto first = static_cast<unsigned>(argc > 2 ? std::atoi(argv[2]) : 0);
    const CtHead* head = ct_head();
    if (!head) return fmt::print(stderr, "The package invesalius-examples is not installed.\n"), 3;
    fmt::print(
        "| twist, degrees in 100 mm | points | yes / ask / no | light off mm: median / worst | worst of a `yes` | "
        "bound mm, median | within |\n|---|---|---|---|---|---|---|\n");
    for (const double degrees : {0., 1.5, 2., 2.5, 3.})
        for (const int points : {1200, 1400, 2000, 20000}) {
            const Row row = measured(*head, degrees, points, first, static_cast<unsigned>(scans));
            fmt::print("| {:g} | {} | {} / {} / {} | {:.2f} / {:.2f} | {} | {:.2f} | {} of {} |\n", degrees, points,
                       row.yes, row.ask, row.no, median(row.off_mm), worst(row.off_mm),
                       row.of_yes_mm.empty() ? "-" : fmt::format("{:.2f}", worst(row.of_yes_mm)), median(row.bound_mm),
                       row.within, row.off_mm.size());
            std::fflush(stdout);
        }
    return 0;
}
