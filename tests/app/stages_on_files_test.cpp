#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "planning_io/case/rig_file.h"
#include "planning_io/plan/point_pairs_file.h"
#include "planning_io/surface/mesh_file.h"
#include "tests/app/on_example_patient.h"

namespace planlight::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

TEST_F(CommandsTest, PatternsWritesTheWholeSequence) {
    const auto run = run_planlight("patterns --width 320 --height 240 --out patterns --json", root());
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const json result = json::parse(run.out);
    for (const auto& name : result["patterns"])
        EXPECT_TRUE(fs::exists(root() / "patterns" / (name.get<std::string>() + ".png")));
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
    EXPECT_EQ(json::parse(check.out)["epipolar_px"], json::parse(scan.out)["epipolar_px"]) << "one figure, one name";
    const auto found = run_planlight(
        "register case --cloud cloud.ply --out registration.json --certificate match.html --json", root());
    ASSERT_EQ(found.exit_code, 0) << found.err;
    std::ifstream certificate(root() / "match.html");
    const std::string page(std::istreambuf_iterator<char>(certificate), {});
    EXPECT_NE(page.find("Yes: the match may be used."), std::string::npos);
    EXPECT_NE(page.find("How far off the match may be"), std::string::npos);
    EXPECT_NE(page.find("pulled along as a whole"), std::string::npos) << "what the bounds cannot know";
    const auto review = run_planlight(
        "review case --registration registration.json --cloud cloud.ply --view before --picture before.png --json",
        root());
    ASSERT_EQ(review.exit_code, 0) << review.err;
    EXPECT_FALSE(json::parse(review.out)["match"].empty());
    EXPECT_EQ(run_planlight("review case --registration cloud.ply", root()).exit_code, 4);
    const auto track =
        run_planlight("track room/frames --rig room/rig.json --capture room/capture --out poses.json --json", root());
    ASSERT_EQ(track.exit_code, 0) << track.err;
    EXPECT_EQ(json::parse(track.out)["poses"], 4);
    // Its discs are of 8 mm: as others they do not meet in space, and what to do is to say their size.
    const auto other = run_planlight(
        "track room/frames --rig room/rig.json --capture room/capture --out other.json --markers 12/24", root());
    EXPECT_EQ(other.exit_code, 6);
    EXPECT_NE(other.err.find("as discs of some 8 mm"), std::string::npos) << other.err;
    EXPECT_NE(other.err.find("--markers DISC/STICKER"), std::string::npos) << other.err;
    EXPECT_EQ(run_planlight("track room/frames --rig room/rig.json --out other.json --markers 8", root()).exit_code, 3);
    const auto picture = run_planlight(
        "project case --rig room/rig.json --registration registration.json --poses poses.json --out light.png --json",
        root());
    ASSERT_EQ(picture.exit_code, 0) << picture.err;
    EXPECT_GT(json::parse(picture.out)["lit_pixels"].get<int>(), 500);

    const Eigen::Matrix4d truth = true_rig_from_ct();
    const Eigen::Matrix4d measured = matrix_of(json::parse(found.out)["patient_from_ct"]);
    const json planned = read_json(plan());
    ASSERT_FALSE(planned["markups"].empty());
    for (const auto& markup : planned["markups"])
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
    expect_one_clear_sentence(run_planlight("register case --cloud foreign.ply --out refused.json", root()), 3,
                              "rig's frame");
    expect_one_clear_sentence(
        run_planlight("register case --cloud foreign.ply --in-rig --unit m --out refused.json", root()), 3, "normals");
    const Eigen::Matrix4d rig_from_camera =
        read_rig(root() / "room" / "rig.json").left_camera.device_from_rig.matrix().inverse();
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
    const std::vector<Eigen::Vector3d> landmarks{
        {120, 60, 60}, {170, 80, 60}, {70, 80, 60}, {195, 150, 50}, {45, 150, 50}};
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
    write("elsewhere.csv", "# SPACE=RAS\n", 0);
    const auto found = run_planlight("register case --pairs good.csv --out pairs.json --json", root());
    ASSERT_EQ(found.exit_code, 0) << found.err;
    EXPECT_EQ(json::parse(found.out)["verdict"], "ask");
    expect_one_clear_sentence(run_planlight("register case --pairs bad.csv --out refused.json", root()), 6, "landmark");
    const std::string kept = read_text(root() / "pairs.json");
    const auto refused = run_planlight("register case --pairs bad.csv --out pairs.json --json", root());
    EXPECT_EQ(refused.exit_code, 6);
    EXPECT_EQ(read_text(root() / "pairs.json"), kept) << "a match that may be used stays";
    const json why = json::parse(refused.out);
    for (const char* name : {"patient_from_ct", "weakest_sigma_mm", "skin_offset_mm", "skin_movement_mm",
                             "shape_change_mm", "residual_median_mm"})
        EXPECT_TRUE(why[name].is_null()) << name << " was not looked at";
    expect_one_clear_sentence(run_planlight("register case --pairs unsaid.csv --out refused2.json", root()), 3,
                              "SPACE=");
    expect_one_clear_sentence(run_planlight("register case --pairs elsewhere.csv --out refused2.json", root()), 3,
                              "off the skin of the case");
    EXPECT_EQ(run_planlight("register case --out refused3.json", root()).exit_code, 2);
    EXPECT_EQ(run_planlight("review case --landmarks good.csv", root()).exit_code, 2)
        << "landmarks are clicked on a scan";
}

TEST_F(CommandsTest, LandmarksCheckAScanAndAScanIsASurface) {
    simulated();
    const auto scanned =
        run_planlight("scan room/capture --rig room/rig.json --out on.ply --surface surface.ply --json", root());
    ASSERT_EQ(scanned.exit_code, 0) << scanned.err;
    const json counts = json::parse(scanned.out);
    const auto points = counts["points"].get<std::size_t>(), triangles = counts["triangles"].get<std::size_t>();
    EXPECT_GT(triangles, points) << "nearly two a point";
    EXPECT_LT(triangles, 2 * points);
    prepared();
    const PointCloud cloud = read_cloud(root() / "surface.ply");
    EXPECT_EQ(cloud.size(), points);
    const Eigen::Matrix4d ct_from_rig = true_rig_from_ct().inverse();
    std::vector<PointPair> pairs;
    for (const double share : {0.1, 0.4, 0.6, 0.9}) {
        const Eigen::Vector3d p_in_rig =
            cloud.points_in_rig[static_cast<std::size_t>(share * static_cast<double>(points))];
        pairs.push_back({std::to_string(pairs.size() + 1), (ct_from_rig * p_in_rig.homogeneous()).head<3>(), p_in_rig});
    }
    write_point_pairs(pairs, root() / "true.csv");
    pairs[1].in_ct.z() += 6;
    write_point_pairs(pairs, root() / "off.csv");
    const auto found =
        run_planlight("register case --cloud surface.ply --pairs true.csv --out yes.json --json", root());
    ASSERT_EQ(found.exit_code, 0) << found.err;
    EXPECT_EQ(json::parse(found.out)["verdict"], "yes") << "the faces do no harm";
    const auto asked = run_planlight("register case --cloud surface.ply --pairs off.csv --out ask.json --json", root());
    EXPECT_EQ(json::parse(asked.out)["verdict"], "ask");
    EXPECT_NE(asked.out.find("\"2\\\" lies"), std::string::npos) << asked.out;
    EXPECT_EQ(run_planlight("review case --cloud surface.ply", root()).exit_code, 2) << "nothing says where it lies";
}

TEST_F(CommandsTest, ScansOfFewerDevicesAndOfAGrayCodeAlone) {
    simulated();
    const json whole_rig = read_json(root() / "room" / "rig.json");
    const auto write = [&](const fs::path& file, const json& content) { std::ofstream(file) << content.dump(); };
    json rig = whole_rig;
    rig.erase("right_camera");
    write(root() / "one.json", rig);
    rig = whole_rig;
    rig.erase("projector");
    write(root() / "two.json", rig);
    rig.erase("right_camera");
    write(root() / "none.json", rig);
    const auto scan = [&](const std::string& capture, const std::string& rig_file) {
        return run_planlight("scan " + capture + " --rig " + rig_file + " --out fewer.ply --json", root());
    };
    const auto whole = scan("room/capture", "room/rig.json"), one = scan("room/capture", "one.json"),
               two = scan("room/capture", "two.json");
    ASSERT_EQ(whole.exit_code, 0) << whole.err;
    ASSERT_EQ(one.exit_code, 0) << one.err;
    ASSERT_EQ(two.exit_code, 0) << two.err;
    EXPECT_EQ(json::parse(whole.out)["devices"], "two cameras and the projector");
    EXPECT_EQ(json::parse(one.out)["devices"], "one camera and the projector");
    EXPECT_EQ(json::parse(two.out)["devices"], "two cameras");
    EXPECT_TRUE(json::parse(one.out)["right"].is_null()) << "no camera, no counts";
    EXPECT_GT(json::parse(one.out)["points"].get<int>(), 10000);
    EXPECT_GT(json::parse(two.out)["points"].get<int>(), 10000);
    EXPECT_EQ(json::parse(whole.out)["movement"]["by"], "markers");
    EXPECT_LT(json::parse(whole.out)["movement"]["moved_mm"].get<double>(), 0.06) << "the simulated patient lies still";
    EXPECT_EQ(json::parse(one.out)["movement"]["by"], "pictures");
    EXPECT_LT(json::parse(one.out)["movement"]["moved_mm"].get<double>(), 0.06);
    expect_one_clear_sentence(scan("room/capture", "none.json"), 3, "nothing else");
    expect_one_clear_sentence(run_planlight("check room/capture --rig one.json", root()), 3, "has no right_camera");

    const auto without = [&](const std::string& name, const std::function<bool(const std::string&)>& leave_out) {
        fs::create_directories(root() / name);
        for (const char* side : {"left", "right"})
            if (!fs::exists(root() / name / side))
                fs::create_directory_symlink(root() / "room" / "capture" / side, root() / name / side);
        json settings = read_json(root() / "room" / "capture" / "capture.json");
        json names = json::array();
        for (const auto& n : settings["names"])
            if (!leave_out(n.get<std::string>())) names.push_back(n);
        settings["names"] = names;
        write(root() / name / "capture.json", settings);
    };
    const auto has = [](const std::string& name, const char* part) { return name.find(part) != std::string::npos; };
    without("gray", [&](const std::string& n) { return has(n, "phase"); });
    without("coarse",
            [&](const std::string& n) { return has(n, "phase") || has(n, "column-gray-6") || has(n, "row-gray-6"); });
    without("hole", [&](const std::string& n) { return n == "column-gray-2"; });
    const auto gray = scan("gray", "room/rig.json"), coarse = scan("coarse", "room/rig.json");
    ASSERT_EQ(gray.exit_code, 0) << gray.err;
    ASSERT_EQ(coarse.exit_code, 0) << coarse.err;
    EXPECT_NE(gray.err.find("to 8 projector pixels"), std::string::npos) << gray.err;
    EXPECT_NE(coarse.err.find("to 16 projector pixels"), std::string::npos) << coarse.err;
    EXPECT_GT(json::parse(coarse.out)["points"].get<int>(), 10000);
    expect_one_clear_sentence(scan("hole", "room/rig.json"), 3, "column-gray-2 missing");
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
