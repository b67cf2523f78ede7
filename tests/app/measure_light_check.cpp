// How well CHECK measures the light: the example patient at rest in simulated rooms, the plan drawn beside its place by
// a known shift, and what `check_light` makes of one frame of both cameras, against where the light truly fell.
// measure_light_check paper|modern FIRST COUNT
#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <random>
#include <string>

#include "app/evaluation/distribution.h"
#include "app/evaluation/measure_overlay.h"
#include "app/prepare_case.h"
#include "app/session.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/types/statistics.h"
#include "planning_io/volume/read_volume.h"
#include "projection/check_light.h"
#include "tests/support/test_data.h"

namespace {

using namespace planlight;
using Eigen::Vector3d;

constexpr double kShifts_mm[] = {0, 0.5, 1, 2};

struct Row {
    std::vector<double> error_mm, shift_error_mm, seen_share, cost_ms;
};

/// A direction along the skin at the plan's first point, square to the projector's sight.
Vector3d sideways(const Vector3d& to_projector_in_ct, std::mt19937& random) {
    std::normal_distribution<double> normal;
    const Vector3d any(normal(random), normal(random), normal(random));
    return (any - any.dot(to_projector_in_ct) * to_projector_in_ct).normalized();
}

void measure(const simulation::SimulatedRig& truth, simulation::SimulatedRig& rig, const Case& the_case,
             const CaseDrawing& drawing, double shift_mm, std::mt19937& random, Row& row) {
    const DrawingRenderer renderer(drawing.skin, rig.calibration().projector);
    const Instant now = rig.clock().now();
    const RigidTransform rig_from_ct = rig.true_rig_from_ct(now);
    const Vector3d towards =
        rig_from_ct.linear().transpose() * (rig.calibration().projector.centre_in_rig() -
                                            rig_from_ct * the_case.plan.osteotomy_lines.front().points_in_ct.front())
                                               .normalized();
    const Vector3d shift_in_ct = shift_mm * sideways(towards, random);
    const RigidTransform drawn = rig_from_ct * Eigen::Translation3d(shift_in_ct);
    const Instant lit = rig.projector().show(renderer.render(drawing.drawing, drawn), now + std::chrono::seconds(10));
    const StereoFrame frame = rig.cameras().grab(lit, std::chrono::seconds(1));
    const auto start = std::chrono::steady_clock::now();
    const LightCheck check = check_light(drawing.drawing, drawing.skin, rig.calibration(), rig_from_ct, frame);
    row.cost_ms.push_back(1000 * seconds(std::chrono::steady_clock::now() - start));
    const OverlayErrors true_errors = measure_overlay(truth, the_case.plan, drawing.drawing, renderer, {},
                                                      {drawn, RigidTransform::Identity(), frame.at}, false);
    row.error_mm.push_back(check.off_mm - quantile(true_errors.position_mm, 0.95));
    for (const ItemLight& item : check.items) {
        if (!item.known()) continue;
        // What the item's strokes can tell of the shift: its part along the skin there.
        const Vector3d direction = item.off_mm > 1e-6 ? Vector3d(item.shift_in_ct / item.off_mm) : towards;
        row.shift_error_mm.push_back(item.off_mm - std::abs(shift_in_ct.dot(direction)));
    }
    row.seen_share.push_back(check.seen_share());
}

}  // namespace

int main(int argc, char** argv) {
    const std::string preset = argc > 1 ? argv[1] : "paper";
    const int first = argc > 2 ? std::atoi(argv[2]) : 1, count = argc > 3 ? std::atoi(argv[3]) : 3;
    if (!test::example_patient()) return 77;
    const Volume volume = read_volume(*test::example_patient());
    const Preparation prepared = prepare_case(
        volume, read_plan(std::string(PLANLIGHT_EXAMPLE_FOLDER) + "/frontal_defect.mrk.json"), {}, {}, "2001-10-14");
    const CaseDrawing drawing(prepared.prepared);
    std::vector<Row> rows(std::size(kShifts_mm));
    for (int seed = first; seed < first + count; ++seed) {
        std::mt19937 random(static_cast<unsigned>(seed));
        simulation::RoomSettings room;
        room.preset = preset == "paper" ? simulation::Preset::paper : simulation::Preset::modern;
        room.seed = static_cast<unsigned>(seed);
        room.skin_threshold_hu = prepared.threshold;  // the skin that was prepared: what CHECK sees is the light alone
        simulation::SimulatedRig rig(volume, points_of(prepared.prepared.plan), room);
        for (std::size_t i = 0; i < rows.size(); ++i)
            measure(rig, rig, prepared.prepared, drawing, kShifts_mm[i], random, rows[i]);
        fmt::print(stderr, "room {}\n", seed);
    }
    fmt::print("{} room, seeds {} to {}\n", preset, first, first + count - 1);
    fmt::print(
        "drawn beside | measured - true, 95 % of the light (median / worst) | item's shift - true (median / 95 % / "
        "worst) | seen | ms\n");
    for (std::size_t i = 0; i < rows.size(); ++i) {
        Row& row = rows[i];
        for (double& e : row.shift_error_mm) e = std::abs(e);
        for (double& e : row.error_mm) e = std::abs(e);
        const Distribution whole = distribution_of(row.error_mm), item = distribution_of(row.shift_error_mm);
        fmt::print("{:.1f} mm | {:.2f} / {:.2f} | {:.2f} / {:.2f} / {:.2f} | {:.0f} % | {:.1f}\n", kShifts_mm[i],
                   whole.median, whole.worst, item.median, item.p95, item.worst, 100 * median(row.seen_share),
                   median(row.cost_ms));
    }
    return 0;
}
