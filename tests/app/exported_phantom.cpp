#include "tests/app/exported_phantom.h"

#include <Eigen/Geometry>

#include "app/prepare_case.h"
#include "planning_io/volume/read_volume.h"
#include "tests/planning_io/synthetic_series.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

Plan plan_there() {
    const Vector3d at = place_on_phantom();
    Plan plan;
    plan.boreholes.push_back({"hole \"1\" <ä>", at, Vector3d(0, 1, 0), 7, 5, {}});
    plan.osteotomy_lines.push_back({"line", {at, at + Vector3d(5, 0, 5), at + Vector3d(10, 0, 0)}, true, {}});
    plan.trajectories.push_back({"way", at, at + Vector3d(0, 30, 0), 2, {}});
    plan.cut_planes.push_back({"cut", at, Vector3d(1, 0, 0), Vector3d(0, 0, 1), 20, 10, {}});
    return plan;
}

ExportedOperation invented(const Case& the_case) {
    ExportedOperation operation;
    RegistrationResult& match = operation.match;
    match.verdict = Verdict::yes;
    match.patient_from_ct =
        Eigen::Translation3d(12.5, -340.25, 901.125) * Eigen::AngleAxisd(1.1, Vector3d(0.3, -0.8, 0.5).normalized());
    match.of_case = name_of(the_case);
    match.covariance.of_turn_and_shift.setIdentity();
    match.covariance.of_turn_and_shift *= 0.01;
    operation.made = "2026-03-14T09:30:00Z";
    operation.cloud.emplace();
    for (std::size_t i = 0; i < the_case.skin.vertices_in_ct.size(); i += 7)
        operation.cloud->points_in_rig.push_back(match.patient_from_ct * the_case.skin.vertices_in_ct[i]);
    operation.facts.emplace();
    OperationFacts& facts = *operation.facts;
    facts.head.case_code = the_case.code, facts.head.case_title = "Ä. Ö., a title";
    facts.head.began_utc = operation.made;
    facts.recording_hash = "0123";
    facts.lasted_s = 100, facts.lit_s = 60, facts.aligned_s = 50, facts.updates = 1000;
    facts.items.push_back({"hole", {{1, 60}}, 59, 0.8, {0.1, 0.2, 0.3}});
    for (int i = 0; i < 100; ++i) facts.course.push_back({static_cast<double>(i), i > 20, 0.3 + 0.01 * i});
    OperationMoment moment{30, "aligned", GrayImage(64, 48), GrayImage(64, 48), RgbImage(80, 60, {0, 255, 0})};
    moment.left.pixels[5] = 200;
    facts.moment = moment;
    return operation;
}

}  // namespace

Vector3d place_on_phantom() {
    Vector3d at{20, -96, 0};
    while (at.y() < 0 && phantom_hu(at) < -300) at.y() += 0.5;
    return at;
}

ExportedPhantom& exported_phantom() {
    static ExportedPhantom& made = *[] {
        auto* phantom = new ExportedPhantom;
        phantom->series = phantom->folder.path() / "series";
        write_series(synthetic_series(Grid{}), phantom->series);
        phantom->prepared = prepare_case(read_volume(phantom->series), plan_there(), {}, {}, "2026-01-02").prepared;
        phantom->operation = invented(phantom->prepared);
        return phantom;
    }();
    return made;
}

}  // namespace planlight::test
