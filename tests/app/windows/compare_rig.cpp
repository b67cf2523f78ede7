// compare_rig RIG TRUTH EVENTS SECONDS: a rig that a guided calibration found against the simulator's truth.json, and
// what its events say. Points: the corners of the board in the truth's own poses, seen without noise by the true rig,
// placed by the found one; a common turn and shift is taken out, for it cancels between scan and light. Exit code 0
// when scanned points and light are within the goals (0.1 mm and 0.25 mm, 95 %), at least eight poses were taken and
// every refusal has a reason.
#include <fmt/format.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "planning_io/case/rig_file.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/statistics.h"
#include "tests/app/rig_error.h"

namespace {

using namespace planlight;
using Eigen::Vector3d;

bool failed = false;

void expect(bool is_true, const char* what) {
    if (!is_true) fmt::print("FAIL {}\n", what);
    failed = failed || !is_true;
}

CameraModel device_of(const nlohmann::json& json) {
    CameraModel d;
    d.width = json.at("width");
    d.height = json.at("height");
    d.focal_x = json.at("focal_x");
    d.focal_y = json.at("focal_y");
    d.centre_x = json.at("centre_x");
    d.centre_y = json.at("centre_y");
    d.k1 = json.at("k1");
    d.k2 = json.at("k2");
    d.p1 = json.at("p1");
    d.p2 = json.at("p2");
    d.k3 = json.at("k3");
    for (int r = 0; r < 4; ++r)
        for (int c = 0; c < 4; ++c)
            d.device_from_rig(r, c) =
                json.at("device_from_rig").at(static_cast<std::size_t>(r)).at(static_cast<std::size_t>(c));
    return d;
}

RigCalibration true_rig(const nlohmann::json& truth) {
    RigCalibration rig;
    rig.left_camera = device_of(truth.at("true_rig").at("left_camera"));
    rig.right_camera = device_of(truth.at("true_rig").at("right_camera"));
    rig.projector = device_of(truth.at("true_rig").at("projector"));
    return rig;
}

std::vector<Vector3d> points_of(const nlohmann::json& truth) {
    std::vector<Vector3d> points;
    for (const auto& rows : truth.at("rig_from_board")) {
        RigidTransform pose = RigidTransform::Identity();
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 4; ++c)
                pose(r, c) = rows.at(static_cast<std::size_t>(r)).at(static_cast<std::size_t>(c));
        test::add_board_points(pose, points);
    }
    return points;
}

void read_events(const std::string& file, std::size_t& poses, std::map<std::string, int>& refused) {
    std::ifstream in(file);
    double seconds = 0;
    for (std::string line; std::getline(in, line);) {
        if (line.empty()) continue;
        const auto event = nlohmann::json::parse(line);
        if (event.contains("at_s")) seconds = event["at_s"];
        if (event["event"] == "refused") {
            ++refused[event.value("fault", std::string("its pictures"))];
            expect(!event.value("why", std::string()).empty() && !event.value("what", std::string()).empty(),
                   "a refused pose has its reason and what to do");
        }
        if (event.contains("poses")) poses = event["poses"];
    }
    fmt::print("     {} poses in {:.0f} s; sent on:", poses, seconds);
    for (const auto& [why, count] : refused) fmt::print(" {} {};", count, why);
    fmt::print("\n");
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 5) return 2;
    const auto truth = nlohmann::json::parse(read_whole(argv[2]));
    const test::RigError errors = test::rig_error(read_rig(argv[1]), true_rig(truth), points_of(truth));
    std::size_t poses = 0;
    std::map<std::string, int> refused;
    read_events(argv[3], poses, refused);
    const double points = quantile(errors.points_mm, 0.95), light = quantile(errors.light_mm, 0.95);
    fmt::print(
        "     true error: points {:.4f} mm, light {:.4f} mm (95 % of {} places; medians {:.4f}, {:.4f}); {} s in all\n",
        points, light, errors.points_mm.size(), median(errors.points_mm), median(errors.light_mm), argv[4]);
    expect(points < 0.1 && light < 0.25, "the rig is as true as the goals want");
    expect(poses >= 8, "eight poses or more were taken");
    return failed;
}
