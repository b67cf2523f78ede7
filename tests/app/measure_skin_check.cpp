// How well a check of the skin tells that all markers slid together, which the light cannot: rooms of other seeds, each
// matched once; then the cap of markers slides along the skin by 0, 1, 2 and 3 mm in a direction drawn at random, and
// the short scan says how far off the plan lies. measure_skin_check paper|modern FIRST_ROOM ROOMS DRAWS_A_SLIDE
#include <fmt/format.h>

#include <random>

#include "app/evaluation/distribution.h"
#include "app/prepare_case.h"
#include "app/session.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/read_volume.h"
#include "projection/light_gate.h"
#include "registration/simulation/simulated_rig.h"
#include "tests/support/test_data.h"

namespace {

using namespace planlight;
using Eigen::Vector3d;
using simulation::SimulatedRig;

struct Sums {
    int draws = 0, not_known = 0, look = 0, stop = 0;
    std::vector<double> found_mm, wrong_mm;
};

/// Along the skin under the marker that is nearest to the middle of all.
Vector3d any_slide(const SimulatedRig& rig, std::mt19937& random) {
    const auto& markers = rig.true_markers_in_ct();
    Vector3d middle = Vector3d::Zero();
    for (const Vector3d& m : markers) middle += m / static_cast<double>(markers.size());
    const RigidTransform rig_from_ct = rig.true_rig_from_ct(rig.clock().now());
    const Vector3d towards =
        (rig_from_ct.inverse() * rig.calibration().projector.centre_in_rig() - middle).normalized();
    const auto skin = rig.true_skin_along(middle + 40 * towards, -towards);
    const Vector3d normal = skin ? skin->normal_in_ct : towards;
    std::normal_distribution<double> gauss;
    const Vector3d any(gauss(random), gauss(random), gauss(random));
    return (any - any.dot(normal) * normal).normalized();
}

}  // namespace

int main(int argc, char** argv) {
    const std::string preset = argc > 1 ? argv[1] : "paper";
    const int first = argc > 2 ? std::stoi(argv[2]) : 1, rooms = argc > 3 ? std::stoi(argv[3]) : 1,
              draws = argc > 4 ? std::stoi(argv[4]) : 2;
    if (!test::example_patient()) return 77;
    const Volume volume = read_volume(*test::example_patient());
    const Preparation prepared = prepare_case(
        volume, read_plan(std::string(PLANLIGHT_EXAMPLE_FOLDER) + "/frontal_defect.mrk.json"), {}, {}, "2001-10-14");
    const CaseDrawing drawing(prepared.prepared);
    const LightGateSettings gate;
    std::map<double, Sums> sums;
    for (int k = 0; k < rooms; ++k) {
        simulation::RoomSettings room;
        room.preset = preset == "paper" ? simulation::Preset::paper : simulation::Preset::modern;
        room.seed = static_cast<unsigned>(first + k);
        SimulatedRig rig(volume, points_of(prepared.prepared.plan), room);
        rig.set_motion({0.0, rig.clock().now()});
        Session session(prepared.prepared, drawing, rig.calibration(), rig.projector(), rig.cameras(), rig.clock());
        session.scan();
        if (session.find_patient().verdict == Verdict::no) continue;
        session.confirm();
        std::mt19937 random(room.seed * 104729);
        for (const double slide_mm : {0.0, 1.0, 2.0, 3.0})
            for (int i = 0; i < draws; ++i) {
                const Vector3d slide = slide_mm * any_slide(rig, random);
                rig.slip_marker(-1, slide);
                const SkinCheck check = session.check_skin();
                rig.slip_marker(-1, -slide);
                Sums& sum = sums[slide_mm];
                ++sum.draws;
                if (!check.known) {
                    ++sum.not_known;
                    fmt::print("room {}: {}\n", first + k, check.why_not);
                    continue;
                }
                sum.found_mm.push_back(check.off_mm);
                sum.wrong_mm.push_back(std::abs(check.off_mm - slide_mm));
                sum.look += check.off_mm > gate.warn_mm;
                sum.stop += check.off_mm > gate.stop_mm;
            }
        fmt::print(stderr, "room {} of {}\n", k + 1, rooms);
    }
    fmt::print(
        "{} rooms, seeds {} to {}\nslide, mm | checks | not known | said to be off, mm (median / 95 % / worst) | "
        "wrong by, mm (median / 95 % / worst) | CHECK | REFUSED\n",
        preset, first, first + rooms - 1);
    for (const auto& [slide_mm, s] : sums) {
        const Distribution found = distribution_of(s.found_mm), wrong = distribution_of(s.wrong_mm);
        fmt::print("{} | {} | {} | {:.2f} / {:.2f} / {:.2f} | {:.2f} / {:.2f} / {:.2f} | {} | {}\n", slide_mm, s.draws,
                   s.not_known, found.median, found.p95, found.worst, wrong.median, wrong.p95, wrong.worst, s.look,
                   s.stop);
    }
    return 0;
}
