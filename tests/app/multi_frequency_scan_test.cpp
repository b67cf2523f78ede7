#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "planning_io/case/capture_folder.h"
#include "planning_io/case/rig_file.h"
#include "planning_io/surface/mesh_file.h"
#include "tests/app/run_command.h"
#include "tests/registration/scan/stripe_room.h"
#include "tests/support/test_data.h"

namespace planlight::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// The folder that someone writes who shows the pictures of `planlight patterns --set multi-frequency`.
CaptureFolder folder_of(const ScanCapture& capture, const json& patterns) {
    CaptureFolder folder;
    folder.projector_width = patterns["projector_width"];
    folder.projector_height = patterns["projector_height"];
    folder.phase_steps = patterns["phase_steps"];
    folder.phase_period_px = patterns["phase_period_px"];
    folder.order_periods_px = patterns["order_periods_px"].get<std::vector<double>>();
    folder.order_steps = patterns["order_steps"];
    folder.rows = patterns["rows"];
    folder.inverse = patterns["inverse"];
    for (const auto& name : patterns["patterns"]) folder.names.push_back(name);
    folder.left = capture.left;
    folder.right = capture.right;
    return folder;
}

TEST(MultiFrequencyOnFiles, ItsPicturesAreWrittenAndTheirCaptureIsScanned) {
    const TemporaryFolder folder;
    const auto patterns =
        run_planlight("patterns --set multi-frequency --width 800 --height 600 --out patterns --json", folder.path());
    ASSERT_EQ(patterns.exit_code, 0) << patterns.err;
    const Eigen::Vector3d centre(120, -40, 360);
    const stripe_room::Room room = stripe_room::paper_room(stripe_room::sphere(centre, 80));
    CaptureFolder capture =
        folder_of(stripe_room::capture(room, multi_frequency_stripes(800, 600)), json::parse(patterns.out));
    ASSERT_EQ(capture.names.size(), capture.left.size());
    write_capture(capture, folder.path() / "capture");
    write_rig(stripe_room::rig_of(room), folder.path() / "rig.json");
    const auto scan = run_planlight("scan capture --rig rig.json --out cloud.ply --json", folder.path());
    ASSERT_EQ(scan.exit_code, 0) << scan.err;
    const PointCloud cloud = read_cloud(folder.path() / "cloud.ply");
    double squares = 0;
    for (const auto& p : cloud.points_in_rig) squares += std::pow((p - centre).norm() - 80, 2);
    EXPECT_GT(cloud.size(), 30000u);
    EXPECT_LT(std::sqrt(squares / static_cast<double>(cloud.size())), 0.05);

    for (auto* list : {&capture.left, &capture.right}) list->erase(list->begin() + 12);
    capture.names.erase(capture.names.begin() + 12);
    write_capture(capture, folder.path() / "hole");
    const auto refused = run_planlight("scan hole --rig rig.json --out none.ply", folder.path());
    EXPECT_EQ(refused.exit_code, 3);
    EXPECT_NE(refused.err.find("is missing"), std::string::npos) << refused.err;
}

}  // namespace
}  // namespace planlight::test
