#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "planning_io/mesh_file.h"
#include "planning_io/rig_file.h"
#include "tests/app/on_example_patient.h"

namespace planlight::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

TEST_F(CommandsTest, PatternsWritesTheWholeSequence) {
    const auto run = run_planlight("patterns --width 320 --height 240 --out patterns --json", root());
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const json result = json::parse(run.out);
    for (const auto& name : result["patterns"]) EXPECT_TRUE(fs::exists(root() / "patterns" / (name.get<std::string>() + ".png")));
    EXPECT_GE(result["patterns"].size(), 2u + 2u * 8u);
}

TEST_F(CommandsTest, StagesOnFilesFindThePatientWithinAMillimetreOfTheTruth) {
    prepared();
    simulated();
    const auto scan = run_planlight("scan room/capture --rig room/rig.json --out cloud.ply --json", root());
    ASSERT_EQ(scan.exit_code, 0) << scan.err;
    const auto check = run_planlight("check room/capture --rig room/rig.json --json", root());
    ASSERT_EQ(check.exit_code, 0) << check.err;
    EXPECT_EQ(json::parse(check.out)["verdict"], "good") << "the patient's own scan checks the rig";
    const auto found = run_planlight("register case --cloud cloud.ply --out registration.json --json", root());
    ASSERT_EQ(found.exit_code, 0) << found.err;
    const auto track =
        run_planlight("track room/frames --rig room/rig.json --capture room/capture --out poses.json --json", root());
    ASSERT_EQ(track.exit_code, 0) << track.err;
    EXPECT_EQ(json::parse(track.out)["poses"], 4);
    const auto picture = run_planlight(
        "project case --rig room/rig.json --registration registration.json --poses poses.json --out light.png --json",
        root());
    ASSERT_EQ(picture.exit_code, 0) << picture.err;
    EXPECT_GT(json::parse(picture.out)["lit_pixels"].get<int>(), 500);

    const Eigen::Matrix4d truth = true_rig_from_ct();
    const Eigen::Matrix4d measured = matrix_of(json::parse(found.out)["patient_from_ct"]);
    for (const auto& markup : read_json(plan())["markups"])
        for (const auto& point : markup["controlPoints"]) {
            const auto p = point["position"].get<std::array<double, 3>>();
            const Eigen::Vector4d h(p[0], p[1], p[2], 1);
            EXPECT_LT((truth * h - measured * h).norm(), 1.0) << point["label"];  // the goal of the whole chain
        }
}

/// The cloud of a PLY file as another scanner would write it: ascii, metres, no normals, no frame.
void write_as_a_foreign_scanner(const PointCloud& cloud, const fs::path& file) {
    std::ofstream out(file);
    out << "ply\nformat ascii 1.0\nelement vertex " << cloud.size()
        << "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    for (const auto& p : cloud.points_in_rig) out << p.x() / 1000 << ' ' << p.y() / 1000 << ' ' << p.z() / 1000 << '\n';
}

TEST_F(CommandsTest, ACloudOfAnotherScannerIsRegisteredOnceItsUnitFrameAndViewpointAreSaid) {
    prepared();
    simulated();
    const auto scan = run_planlight("scan room/capture --rig room/rig.json --out scanned.ply", root());
    ASSERT_EQ(scan.exit_code, 0) << scan.err;
    write_as_a_foreign_scanner(read_cloud(root() / "scanned.ply"), root() / "foreign.ply");
    expect_one_clear_sentence(run_planlight("register case --cloud foreign.ply --out refused.json", root()), 3, "rig's frame");
    expect_one_clear_sentence(
        run_planlight("register case --cloud foreign.ply --in-rig --unit m --out refused.json", root()), 3, "normals");
    const Eigen::Matrix4d rig_from_camera = read_rig(root() / "room" / "rig.json").left_camera.device_from_rig.matrix().inverse();
    const auto found = run_planlight(
        fmt::format("register case --cloud foreign.ply --in-rig --unit m --viewpoint {} {} {} --slicer match.tfm "
                    "--out foreign.json --json",
                    rig_from_camera(0, 3), rig_from_camera(1, 3), rig_from_camera(2, 3)),
        root());
    ASSERT_EQ(found.exit_code, 0) << found.err;
    const Eigen::Matrix4d truth = true_rig_from_ct();
    const Eigen::Matrix4d measured = matrix_of(json::parse(found.out)["patient_from_ct"]);
    const Eigen::Vector4d target(120, 140, 80, 1);  // in the middle of the head
    EXPECT_LT((truth * target - measured * target).norm(), 1.0);

    // The file as ITK defines it: a point after the transform -> the point before it: from the CT back to the scan.
    std::ifstream tfm(root() / "match.tfm");
    std::string word;
    while (tfm >> word && word != "Parameters:") continue;
    Eigen::Matrix3d A;
    Eigen::Vector3d t;
    for (double& value : A.reshaped<Eigen::RowMajor>()) tfm >> value;
    for (double& value : t) tfm >> value;
    EXPECT_LT((A * target.head<3>() + t - (truth * target).head<3>()).norm(), 1.0);
}

TEST_F(CommandsTest, LandmarksAloneAreAskedForAndWrongOnesAreRefused) {
    prepared();
    const Eigen::Matrix4d truth = true_rig_from_ct();
    const std::vector<Eigen::Vector3d> landmarks{{120, 60, 60}, {170, 80, 60}, {70, 80, 60}, {195, 150, 50}, {45, 150, 50}};
    const auto write = [&](const std::string& name, const std::string& space, double shift) {
        std::ofstream out(root() / name);
        out << space << "name,ct_x,ct_y,ct_z,rig_x,rig_y,rig_z\n";
        for (std::size_t i = 0; i < landmarks.size(); ++i) {
            const Eigen::Vector4d p = truth * landmarks[i].homogeneous();
            out << 'L' << i << ',' << landmarks[i].x() << ',' << landmarks[i].y() << ',' << landmarks[i].z() << ','
                << p.x() + shift * static_cast<double>(i % 2) << ',' << p.y() << ',' << p.z() << '\n';
        }
    };
    write("good.csv", "# SPACE=LPS\n", 1);
    write("bad.csv", "# SPACE=LPS\n", 40);
    write("unsaid.csv", "", 0);
    const auto found = run_planlight("register case --pairs good.csv --out pairs.json --json", root());
    ASSERT_EQ(found.exit_code, 0) << found.err;
    EXPECT_EQ(json::parse(found.out)["verdict"], "ask");
    expect_one_clear_sentence(run_planlight("register case --pairs bad.csv --out refused.json", root()), 6, "landmark");
    expect_one_clear_sentence(run_planlight("register case --pairs unsaid.csv --out refused2.json", root()), 3, "SPACE=");
    EXPECT_EQ(run_planlight("register case --out refused3.json", root()).exit_code, 2);
}

TEST_F(CommandsTest, ATableIsNoPatient) {
    prepared();
    std::ofstream ply(root() / "plane.ply");
    ply << "ply\nformat ascii 1.0\ncomment FRAME=rig\nelement vertex 2500\nproperty double x\nproperty double "
           "y\nproperty double z\n"
           "property double nx\nproperty double ny\nproperty double nz\nend_header\n";
    for (int i = 0; i < 50; ++i)
        for (int j = 0; j < 50; ++j) ply << 4 * i << ' ' << 4 * j << " 900 0 0 -1\n";
    ply.close();
    const auto run = run_planlight("register case --cloud plane.ply --out plane.json", root());
    expect_one_clear_sentence(run, 6, "the patient was not found");
}

}  // namespace
}  // namespace planlight::test
