#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "planning_io/mesh_file.h"
#include "planning_io/rig_file.h"
#include "tests/app/run_command.h"
#include "tests/planning_io/synthetic_series.h"
#include "tests/support/test_data.h"

namespace planlight::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::string kPlan = std::string(PLANLIGHT_EXAMPLE_FOLDER) + "/frontal_defect.mrk.json";

/// One case and one simulated room on disk, made by the commands themselves, for all tests.
class CommandsTest : public ::testing::Test {
protected:
    static void SetUpTestSuite() {
        if (!example_patient()) return;
        folder_ = std::make_unique<TemporaryFolder>();
        prepared_ = run_planlight("prepare " + example_patient()->string() + " --plan " + kPlan + " --out case --json", root());
        simulated_ = run_planlight("simulate " + example_patient()->string() + " --plan " + kPlan +
                                       " --preset paper --seed 4 --frames 4 --out room --json", root());
    }
    static void TearDownTestSuite() { folder_.reset(); }
    void SetUp() override {
        if (!example_patient()) GTEST_SKIP() << "the package invesalius-examples is not installed";
    }
    static const fs::path& root() { return folder_->path(); }

    static std::unique_ptr<TemporaryFolder> folder_;
    static CommandRun prepared_, simulated_;
};
std::unique_ptr<TemporaryFolder> CommandsTest::folder_;
CommandRun CommandsTest::prepared_, CommandsTest::simulated_;

json read_json(const fs::path& file) {
    std::ifstream in(file);
    return json::parse(in);
}

Eigen::Matrix4d matrix_of(const json& rows) {
    Eigen::Matrix4d m;
    for (int r = 0; r < 4; ++r)
        for (int c = 0; c < 4; ++c) m(r, c) = rows[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)].get<double>();
    return m;
}

/// One sentence that says the problem and the remedy, and nothing else: no stack, no second line.
void expect_one_clear_sentence(const CommandRun& run, int exit_code, const std::string& about) {
    EXPECT_EQ(run.exit_code, exit_code) << run.err;
    EXPECT_NE(run.err.find("planlight: "), std::string::npos) << run.err;
    EXPECT_NE(run.err.find(about), std::string::npos) << run.err;
    EXPECT_EQ(run.err.find("fault of ours"), std::string::npos) << run.err;
    std::istringstream lines(run.err);
    int said = 0;
    for (std::string line; std::getline(lines, line);) said += line.starts_with("planlight: ");
    EXPECT_EQ(said, 1) << run.err;
}

TEST_F(CommandsTest, PrepareMakesACaseThatSaysWhatItHolds) {
    ASSERT_EQ(prepared_.exit_code, 0) << prepared_.err;
    const json result = json::parse(prepared_.out);
    EXPECT_EQ(result["plan_items"], 6);
    // An adult head down to the upper lip: 2 to 5 litres.
    EXPECT_GT(result["body_ml"].get<double>(), 2000);
    EXPECT_LT(result["body_ml"].get<double>(), 5000);
    EXPECT_TRUE(fs::exists(root() / "case" / "case.json"));
}

TEST_F(CommandsTest, PrepareEndsWithAReportThatNeedsNothingElse) {
    ASSERT_EQ(prepared_.exit_code, 0) << prepared_.err;
    std::ifstream in(root() / "case" / "report.html");
    const std::string page((std::istreambuf_iterator<char>(in)), {});
    std::size_t pictures = 0;
    for (auto at = page.find("data:image/png;base64,"); at != std::string::npos;
         at = page.find("data:image/png;base64,", at + 1))
        ++pictures;
    EXPECT_EQ(pictures, 7u) << "three slices, the head from four sides";
    EXPECT_EQ(page.find("://"), std::string::npos) << "nothing comes from a network";
    const json report = read_json(root() / "case" / "report.json");
    EXPECT_EQ(report["case"], json::parse(prepared_.out)["case"]);
    ASSERT_EQ(report["items"].size(), 6u);
    for (const auto& item : report["items"]) EXPECT_LT(item["distance_to_skin_mm"].get<double>(), 10) << item["name"];
}

TEST_F(CommandsTest, TheExamplePlanRaisesNoWarningOnItsPatient) {
    ASSERT_EQ(prepared_.exit_code, 0) << prepared_.err;
    for (const auto& warning : json::parse(prepared_.out)["warnings"])
        for (const char* item : {"Osteotomy", "B1", "B2", "B3", "B4", "T1"})
            EXPECT_EQ(warning.get<std::string>().find(item), std::string::npos) << warning;
}

TEST_F(CommandsTest, StagesOnFilesFindThePatientWithinAMillimetreOfTheTruth) {
    ASSERT_EQ(simulated_.exit_code, 0) << simulated_.err;
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

    const Eigen::Matrix4d truth = matrix_of(read_json(root() / "room" / "truth.json")["scan_rig_from_ct"]);
    const Eigen::Matrix4d measured = matrix_of(json::parse(found.out)["patient_from_ct"]);
    for (const auto& markup : read_json(kPlan)["markups"])
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
    const Eigen::Matrix4d truth = matrix_of(read_json(root() / "room" / "truth.json")["scan_rig_from_ct"]);
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
    const Eigen::Matrix4d truth = matrix_of(read_json(root() / "room" / "truth.json")["scan_rig_from_ct"]);
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

TEST_F(CommandsTest, PatternsWritesTheWholeSequence) {
    const auto run = run_planlight("patterns --width 320 --height 240 --out patterns --json", root());
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const json result = json::parse(run.out);
    for (const auto& name : result["patterns"]) EXPECT_TRUE(fs::exists(root() / "patterns" / (name.get<std::string>() + ".png")));
    EXPECT_GE(result["patterns"].size(), 2u + 2u * 8u);
}

/// Whether any file of the folder holds the text.
bool folder_says(const fs::path& folder, const std::string& text) {
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        std::ifstream in(entry.path(), std::ios::binary);
        std::stringstream all;
        all << in.rdbuf();
        if (all.str().find(text) != std::string::npos ||
            entry.path().filename().string().find(text) != std::string::npos)
            return true;
    }
    return false;
}

TEST_F(CommandsTest, AnAnonymousCaseHoldsNoNameIdOrPathOfTheSeries) {
    const SeriesLook look{.patient = "Mustermann^Erika", .patient_id = "ID-4711", .description = "Kopf duenn"};
    write_series(synthetic_series({}, look), root() / "Mustermann");
    std::ofstream(root() / "hole.mrk.json")
        << R"({"@schema": "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/Schema/markups-schema-v1.0.3.json#",
        "markups": [{"type": "Fiducial", "coordinateSystem": "LPS", "coordinateUnits": "mm",
        "controlPoints": [{"id": "1", "label": "B1", "position": [71, 4, 20], "description": "diameter_mm=7 depth_mm=6", "positionStatus": "defined"}]}]})";
    const std::string frame_uid = "1.2.826.0.1.3680043.9.9999.5";
    const std::vector<std::string> identity = {"Mustermann", "Erika",   "ID-4711",      "Kopf duenn",
                                               look.uid,     frame_uid, root().string()};
    const auto named = run_planlight("prepare Mustermann --plan hole.mrk.json --voxel-mm 4 --out named_case --json", root());
    ASSERT_EQ(named.exit_code, 0) << named.err;
    EXPECT_TRUE(folder_says(root() / "named_case", look.uid)) << "the search finds what is there";
    const auto run = run_planlight(
        "prepare Mustermann --plan hole.mrk.json --voxel-mm 4 --out anonymous_case --anonymous --json", root());
    ASSERT_EQ(run.exit_code, 0) << run.err;
    for (const auto& text : identity) {
        EXPECT_FALSE(folder_says(root() / "anonymous_case", text)) << text;
        const bool is_uid = text == look.uid || text == frame_uid;  // no case holds more than these
        EXPECT_EQ(folder_says(root() / "named_case", text), is_uid) << text;
        EXPECT_EQ(run.out.find(text), std::string::npos) << text;
    }
}

TEST_F(CommandsTest, AMissingFileIsSaidSo) {
    expect_one_clear_sentence(run_planlight("prepare nowhere.inv3 --plan " + kPlan + " --out new", root()), 3, "nowhere.inv3");
    EXPECT_FALSE(fs::exists(root() / "new"));
}

TEST_F(CommandsTest, ATruncatedVolumeIsDamagedAndLeavesNothing) {
    fs::copy_file(*example_patient(), root() / "short.inv3", fs::copy_options::overwrite_existing);
    fs::resize_file(root() / "short.inv3", 3'000'000);
    expect_one_clear_sentence(run_planlight("prepare short.inv3 --plan " + kPlan + " --out new", root()), 4, "short.inv3");
    for (const auto& entry : fs::directory_iterator(root()))
        EXPECT_FALSE(entry.path().filename().string().starts_with("new")) << entry.path();
}

TEST_F(CommandsTest, APlanInAnUnknownFrameIsRefusedNotGuessed) {
    json plan = read_json(kPlan);
    plan["markups"][0]["coordinateSystem"] = "lps";  // 3D Slicer reads a mistyped frame as RAS without a word
    std::ofstream(root() / "odd.mrk.json") << plan;
    expect_one_clear_sentence(
        run_planlight("prepare " + example_patient()->string() + " --plan odd.mrk.json --out new", root()), 3, "lps");
}

TEST_F(CommandsTest, APlanReadInTheWrongFrameIsRefusedByNameAndLeavesNothing) {
    json plan = read_json(kPlan);
    for (auto& markup : plan["markups"]) markup["coordinateSystem"] = "RAS";  // turned by 180 degrees about z
    std::ofstream(root() / "turned.mrk.json") << plan;
    const auto run =
        run_planlight("prepare " + example_patient()->string() + " --plan turned.mrk.json --out turned --json", root());
    expect_one_clear_sentence(run, 3, "does not fit this patient");
    for (const char* item : {"Osteotomy", "outside the volume"}) EXPECT_NE(run.err.find(item), std::string::npos) << run.err;
    EXPECT_FALSE(fs::exists(root() / "turned"));
}

TEST_F(CommandsTest, PlanListsChecksAndConverts) {
    ASSERT_EQ(prepared_.exit_code, 0) << prepared_.err;
    std::ofstream(root() / "t.csv") << "name,ex,ey,ez,tx,ty,tz,diameter_mm\nT1,-139.68,190.04,120.85,-132.49,134.29,99.87,2.5\n";
    expect_one_clear_sentence(run_planlight("plan t.csv --case case", root()), 3, "does not say its coordinate system");
    expect_one_clear_sentence(run_planlight("plan t.csv --frame LPS --case case", root()), 3, "T1");
    const auto run = run_planlight("plan t.csv --frame RAS --case case --out t.mrk.json --json", root());
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const json item = json::parse(run.out)["items"][0];
    EXPECT_EQ(item["kind"], "trajectory");
    EXPECT_LT(item["to_skin_mm"].get<double>(), 3);          // the example plan's own entry
    EXPECT_GT(item["left_of_middle_mm"].get<double>(), 10);  // at x = 139.68, the head's middle near 124
    const auto position = read_json(root() / "t.mrk.json")["markups"][0]["controlPoints"][0]["position"];
    EXPECT_EQ(position[0], 139.68);
    // An InVesalius project has no frame of reference: no RTSTRUCT can be written for it.
    expect_one_clear_sentence(run_planlight("plan t.mrk.json --case case --out t.dcm", root()), 3, "frame of reference");
    EXPECT_FALSE(fs::exists(root() / "t.dcm"));
    ASSERT_EQ(run_planlight("plan " + kPlan + " --case case --out all.vtp", root()).exit_code, 0);
    const auto again = run_planlight("plan all.vtp --case case --json", root());
    ASSERT_EQ(again.exit_code, 0) << again.err;
    EXPECT_EQ(json::parse(again.out)["items"].size(), 6U);
}

TEST_F(CommandsTest, AnotherProgramsSurfaceCanBeProjectedOn) {
    // The case's own skin, given back as a surface: the same case, without a segmentation.
    const std::string prepare = "prepare " + example_patient()->string() + " --plan " + kPlan;
    const auto run = run_planlight(prepare + " --surface case/skin.ply --out on_skin --json", root());
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const json own = json::parse(prepared_.out), result = json::parse(run.out);
    EXPECT_EQ(result["skin"], own["skin"]);
    EXPECT_EQ(result["case"], own["case"]);
    EXPECT_EQ(run_planlight("review on_skin --picture on_skin.png", root()).exit_code, 0);
    // The same with the frame not said, said wrongly, and said rightly.
    std::ifstream in(root() / "case" / "skin.ply", std::ios::binary);
    std::string ply((std::istreambuf_iterator<char>(in)), {});
    ply.replace(ply.find("SPACE=LPS"), 9, "no space ");
    std::ofstream(root() / "unsaid.ply", std::ios::binary) << ply;
    expect_one_clear_sentence(run_planlight(prepare + " --surface unsaid.ply --out never", root()), 3,
                              "does not say its coordinate system");
    expect_one_clear_sentence(run_planlight(prepare + " --surface unsaid.ply --surface-frame RAS --out never", root()), 3,
                              "outside the volume");
    EXPECT_EQ(run_planlight(prepare + " --surface unsaid.ply --surface-frame LPS --out said", root()).exit_code, 0);
    EXPECT_FALSE(fs::exists(root() / "never"));
}

TEST_F(CommandsTest, ALutOfAnotherCaseIsRefused) {
    ASSERT_EQ(run_planlight("prepare " + example_patient()->string() + " --plan " + kPlan +
                                " --threshold -200 --voxel-mm 2 --out other",
                            root())
                  .exit_code,
              0);
    fs::copy_file(root() / "other" / "skin.lut", root() / "mixed.lut", fs::copy_options::overwrite_existing);
    fs::remove_all(root() / "mixed");
    fs::copy(root() / "case", root() / "mixed", fs::copy_options::recursive);
    fs::rename(root() / "mixed.lut", root() / "mixed" / "skin.lut");
    const auto run = run_planlight("review mixed --picture x.png", root());
    EXPECT_TRUE(run.exit_code == 3 || run.exit_code == 4) << run.err;
    expect_one_clear_sentence(run, run.exit_code, "mixed");
    EXPECT_FALSE(fs::exists(root() / "x.png"));
}

TEST_F(CommandsTest, ASingleFlippedByteInTheLutIsNoticed) {
    fs::remove_all(root() / "flipped");
    fs::copy(root() / "case", root() / "flipped", fs::copy_options::recursive);
    const auto file = root() / "flipped" / "skin.lut";
    std::fstream lut(file, std::ios::in | std::ios::out | std::ios::binary);
    lut.seekg(static_cast<std::streamoff>(fs::file_size(file) / 2));
    const char byte = static_cast<char>(lut.get());
    lut.seekp(static_cast<std::streamoff>(fs::file_size(file) / 2));
    lut.put(static_cast<char>(byte ^ 1));
    lut.close();
    expect_one_clear_sentence(run_planlight("review flipped --picture x.png", root()), 4, "skin.lut");
}

TEST_F(CommandsTest, ARigFileWithNonsenseIsRefused) {
    const json good = read_json(root() / "room" / "rig.json");
    const auto refused = [&](const std::string& what, json bad) {
        std::ofstream(root() / "bad.json") << bad;
        const auto run = run_planlight("scan room/capture --rig bad.json --out never.ply", root());
        EXPECT_EQ(run.exit_code, 3) << what << ": " << run.err;
        EXPECT_FALSE(fs::exists(root() / "never.ply")) << what;
    };
    // Every number of the file made NaN-like or zero one at a time would be long; the ones that hurt most:
    json flat = good.flatten();
    for (auto& [path, value] : flat.items()) {
        if (!value.is_number() || path.find("focal") == std::string::npos) continue;
        json bad = flat;
        bad[path] = -100.0;
        refused(path, bad.unflatten());
    }
    json sheared = good.flatten();
    for (auto& [path, value] : sheared.items())
        if (value.is_number_float() && path.find("from_rig") != std::string::npos) value = value.get<double>() * 1.5;
    refused("a rotation that is none", sheared.unflatten());
}

TEST_F(CommandsTest, AnotherHeadOrNoHeadGivesExitSixAndAReason) {
    std::ofstream ply(root() / "plane.ply");
    ply << "ply\nformat ascii 1.0\ncomment FRAME=rig\nelement vertex 2500\nproperty double x\nproperty double "
           "y\nproperty double z\n"
           "property double nx\nproperty double ny\nproperty double nz\nend_header\n";
    for (int i = 0; i < 50; ++i)
        for (int j = 0; j < 50; ++j) ply << 4 * i << ' ' << 4 * j << " 900 0 0 -1\n";
    ply.close();
    const auto run = run_planlight("register case --cloud plane.ply --out plane.json", root());
    EXPECT_TRUE(run.exit_code == 6 || run.exit_code == 3) << run.exit_code << run.err;
}

TEST_F(CommandsTest, WrongUsageGivesExitTwo) {
    EXPECT_EQ(run_planlight("prepare", root()).exit_code, 2);
    EXPECT_EQ(run_planlight("nonsense", root()).exit_code, 2);
    EXPECT_EQ(run_planlight("demo --preset both --seeds -3", root()).exit_code, 2);
}

TEST_F(CommandsTest, EveryCommandExplainsItselfWithAnExample) {
    for (const char* name :
         {"demo", "prepare", "plan", "patterns", "scan", "register", "track", "project", "session", "review", "simulate",
          "board", "calibrate", "check"}) {
        const auto run = run_planlight(std::string(name) + " --help", root());
        EXPECT_EQ(run.exit_code, 0) << name;
        EXPECT_NE(run.out.find("Example:"), std::string::npos) << name;
    }
}

TEST_F(CommandsTest, AWindowWithoutADisplayIsADeviceError) {
    const auto run = run_planlight("review case", root());
    if (std::getenv("DISPLAY")) GTEST_SKIP() << "there is a display";
    expect_one_clear_sentence(run, 5, "display");
}

TEST_F(CommandsTest, ACaseOnAGivenSurfaceSpeaksOfNoThreshold) {
    ASSERT_EQ(prepared_.exit_code, 0) << prepared_.err;
    const CommandRun run = run_planlight("prepare " + example_patient()->string() + " --plan " + kPlan +
                                             " --surface case/skin.ply --out on_surface --json", root());
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const json report = read_json(root() / "on_surface" / "report.json");
    EXPECT_TRUE(report["surface_given"].get<bool>());
    EXPECT_FALSE(report.contains("threshold"));
    std::ifstream in(root() / "on_surface" / "report.html");
    const std::string html((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
    EXPECT_EQ(html.find("Skin threshold"), std::string::npos);
    EXPECT_NE(html.find("as given"), std::string::npos);
    EXPECT_GT(json::parse(prepared_.out)["edge_sigma_mm"].get<double>(), 0);
}

}  // namespace
}  // namespace planlight::test
