// Patients under a sheet with a hole that lies on the head: measure_sheet_rooms [FIRST SEED] [ROOMS] (default 101, 10).
//
// The paper's room, the example patient and plan; the hole is 60 to 150 mm wide, the skin dry or wet, and in two of
// three rooms a hand, a tube, a retractor or hair is there as well. The scan goes through the match as `register` does
// it, with what lies close on the skin left out and without; at every point of the plan the pose is compared with the
// truth.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <random>
#include <string>

#include "app/belonging.h"
#include "app/prepare_case.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/volume/read_volume.h"
#include "registration/matching/register_patient.h"
#include "registration/simulation/simulated_rig.h"
#include "tests/support/test_data.h"

namespace {

using namespace planlight;
using Eigen::Vector3d;

simulation::RoomSettings settings_of(unsigned seed, std::string& words) {
    std::mt19937 random(seed);
    simulation::RoomSettings room;
    room.preset = simulation::Preset::paper;
    room.seed = seed;
    room.things.drape_hole = true;
    room.things.hole_mm = std::uniform_int_distribution<int>(60, 150)(random);
    room.wet = std::uniform_int_distribution<int>(0, 1)(random);
    const int more = std::uniform_int_distribution<int>(0, 5)(random);
    room.things.hand = more == 0, room.things.tube = more == 1, room.things.retractor = more == 2;
    room.things.hair = more == 3;
    static const char* const kMore[] = {", a hand", ", a tube", ", a retractor", ", hair", "", ""};
    words = fmt::format("{:.0f} mm{}{}", room.things.hole_mm, room.wet > 0 ? ", wet" : "", kMore[more]);
    return room;
}

/// The worst at the plan's points, and the bound there.
std::string outcome(const RegistrationResult& match, const Case& the_case, const RigidTransform& rig_from_ct) {
    if (match.verdict == Verdict::no) return "no";
    double worst_mm = 0, bound_mm = 0;
    for (const Vector3d& p : points_of(the_case.plan)) {
        const double off_mm = (match.patient_from_ct * p - rig_from_ct * p).norm();
        if (off_mm > worst_mm) worst_mm = off_mm, bound_mm = predicted_light_mm(match, p);
    }
    return fmt::format("`{}` {:.2f} of {:.1f} mm{}", match.verdict == Verdict::yes ? "yes" : "ask", worst_mm, bound_mm,
                       worst_mm > bound_mm ? " **beyond**" : "");
}

}  // namespace

int main(int argc, char** argv) {
    const unsigned first = argc > 1 ? static_cast<unsigned>(std::atoi(argv[1])) : 101,
                   rooms = argc > 2 ? static_cast<unsigned>(std::atoi(argv[2])) : 10;
    const auto patient = test::example_patient();
    if (!patient) {
        fmt::print("skipped: the example patient is not installed\n");
        return 77;
    }
    const Volume volume = read_volume(*patient);
    const Case the_case =
        prepare_case(volume, read_plan(std::string(PLANLIGHT_EXAMPLE_FOLDER) + "/frontal_defect.mrk.json"), {}, {},
                     "2001-10-14")
            .prepared;
    fmt::print("| seed, hole | all that was found | the innermost layer |\n|---|---|---|\n");
    for (unsigned seed = first; seed < first + rooms; ++seed) {
        std::string words;
        simulation::SimulatedRig room(volume, points_of(the_case.plan), settings_of(seed, words));
        StripeSettings stripes;
        stripes.width = room.projector().width();
        stripes.height = room.projector().height();
        const ScanCapture capture = capture_scan(room.projector(), room.cameras(), room.clock(), stripes);
        const ScanResult scan = scan_from_capture(capture, room.calibration(), {});
        fmt::print("| {}, {} |", seed, words);
        for (const bool left_out : {false, true}) {
            RegistrationSettings matching;
            matching.leave_cloth_out = left_out;
            matching.viewpoint_in_rig = scan.rig.rig.projector.centre_in_rig();
            RegistrationResult match = register_patient(scan.clean.kept, the_case.lut, matching);
            take_case_and_rig(the_case, named_rig_state(scan, room.calibration(), capture), match);
            fmt::print(" {} |", outcome(match, the_case, room.true_rig_from_ct(capture.began)));
        }
        fmt::print("\n");
        std::fflush(stdout);
    }
}
