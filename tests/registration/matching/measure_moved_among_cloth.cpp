// What leaving out cloth that lies close on the skin costs where none does, and skin moved instead: not a test, a
// measurement (registration/matching/TRIALS.md).
// measure_moved_among_cloth [SCANS [FIRST]]: scans of the analytic head from the front (default 36, from seed 1), the
// skin moved by each of eleven ways in turn, 0.5 and 0.9 mm rms; cloth lies 2.5 mm and more over it outside of 62 mm.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "planning_io/types/pose_covariance.h"
#include "planning_io/types/statistics.h"
#include "registration/matching/register_patient.h"
#include "tests/registration/matching/matching_scenes.h"
#include "tests/registration/matching/moved_skin.h"

namespace {

using namespace planlight;
using Eigen::Vector3d;

struct Scan {
    PointCloud cloud;
    RigidTransform rig_from_ct;
    Vector3d target_in_ct;
};

Scan scan_of(unsigned seed, double moved_mm) {
    constexpr double kSkin_mm = 62, kOver_mm = 2.5, kRises = 0.8, kNoise_mm = 0.1, kDeep_mm = 60;
    std::vector<std::string> ways{test::kSwollenSide};
    for (const test::SkinMovement& way : test::skin_movements()) ways.push_back(way.name);
    const PointCloud still = test::spoiled(test::head_view(test::View::front, 200, 16000, seed), kNoise_mm, 0, seed);
    PointCloud cloud = test::with_moved_skin(still, ways[seed % ways.size()], moved_mm, seed);
    Vector3d middle = Vector3d::Zero();
    for (const Vector3d& p : still.points_in_rig) middle += p / static_cast<double>(still.size());
    for (std::size_t i = 0; i < still.size(); ++i) {
        const Vector3d& p = still.points_in_rig[i];
        const double aside_mm = std::hypot(p.x() - middle.x(), p.z() - middle.z());
        if (aside_mm > kSkin_mm)
            cloud.points_in_rig[i] += (kOver_mm + kRises * (aside_mm - kSkin_mm)) * still.normals_in_rig[i];
    }
    const RigidTransform rig_from_ct = test::random_pose(seed);
    return {test::moved(cloud, rig_from_ct), rig_from_ct, middle + kDeep_mm * Vector3d::UnitY()};
}

struct Row {
    int yes = 0, ask = 0, no = 0, yes_beyond = 0;
    std::vector<double> errors_mm;
    double worst_yes_mm = 0;

    void add(const Scan& scan, const RegistrationResult& found) {
        ++(found.verdict == Verdict::yes ? yes : found.verdict == Verdict::ask ? ask : no);
        if (found.verdict == Verdict::no) return;
        const double error_mm =
            test::target_error_mm(found.patient_from_ct.inverse(), scan.rig_from_ct.inverse(), scan.cloud);
        errors_mm.push_back(error_mm);
        if (found.verdict != Verdict::yes) return;
        worst_yes_mm = std::max(worst_yes_mm, error_mm);
        yes_beyond += error_mm > predicted_error(found.covariance, scan.target_in_ct).bound_95_mm;
    }
};

}  // namespace

int main(int argc, char** argv) {
    const unsigned scans = argc > 1 ? static_cast<unsigned>(std::atoi(argv[1])) : 36,
                   first = argc > 2 ? static_cast<unsigned>(std::atoi(argv[2])) : 1;
    fmt::print(
        "| skin moved, mm rms | layers | yes / ask / no | `yes` beyond its bound | error mm: median, 90 %, worst | "
        "worst `yes` mm |\n"
        "|---|---|---|---|---|---|\n");
    for (const double moved_mm : {0.5, 0.9})
        for (const bool left_out : {false, true}) {
            RegistrationSettings settings;
            settings.leave_cloth_out = left_out;
            Row row;
            for (unsigned seed = first; seed < first + scans; ++seed) {
                const Scan scan = scan_of(seed, moved_mm);
                row.add(scan, register_patient(scan.cloud, test::head_lut(), settings));
            }
            if (row.errors_mm.empty()) continue;
            fmt::print("| {:.1f} | {} | {} / {} / {} | {} | {:.2f}, {:.2f}, {:.2f} | {:.2f} |\n", moved_mm,
                       left_out ? "the innermost" : "all", row.yes, row.ask, row.no, row.yes_beyond,
                       median(row.errors_mm), quantile(row.errors_mm, 0.9), quantile(row.errors_mm, 1),
                       row.worst_yes_mm);
        }
}
