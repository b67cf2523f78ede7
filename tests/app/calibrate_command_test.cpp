#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/app/run_command.h"
#include "tests/support/test_data.h"

namespace planlight::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// From simulated captures to rig.json; then what goes wrong leaves the good file alone. One test: the captures take
/// their time.
TEST(CalibrateCommand, MakesARigOfCapturesAndNeverSavesABadOneOverAGoodOne) {
    const TemporaryFolder folder;
    const fs::path& root = folder.path();
    const std::string board = " --board 'charuco 10x7 25 mm'";
    const auto simulated =
        run_planlight("simulate" + board + " --preset paper --seed 2 --poses 4 --out room --json", root);
    ASSERT_EQ(simulated.exit_code, 0) << simulated.err;
    std::ofstream(root / "rig.json") << "what stood here before";
    const auto run = run_planlight(
        "calibrate room/captures" + board + " --serial-left L-1 --serial-projector P-9 --out rig.json --json", root);
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const json report = json::parse(run.out), rig = json::parse(whole(root / "rig.json")),
               truth = json::parse(whole(root / "room" / "truth.json"))["true_rig"];
    for (const char* device : {"left_camera", "right_camera", "projector"}) {
        EXPECT_NEAR(rig[device]["focal_x"].get<double>(), truth[device]["focal_x"].get<double>(), 4) << device;
        EXPECT_LT(report["devices"][device]["held_out_rms_px"].get<double>(), 0.2) << device;
    }
    EXPECT_EQ(report["poses"], 4);
    EXPECT_EQ(whole(root / "rig-before.json"), "what stood here before") << "a file is never written over in silence";
    const std::string page = whole(root / "rig-calibration.html");
    EXPECT_NE(page.find("Predicted error over the working volume"), std::string::npos);
    EXPECT_EQ(page.find("http"), std::string::npos) << "nothing comes from a network";
    EXPECT_NE(page.find("0 mm</text>"), std::string::npos) << "the colours have a scale";
    EXPECT_NE(page.find("</i>pose-01</span>"), std::string::npos) << "and the poses' colours a key";
    EXPECT_EQ(page.find("not a medical device"), page.rfind("not a medical device")) << "it is said once";

    EXPECT_EQ(rig["left_camera"]["serial"], "L-1");
    EXPECT_EQ(report["devices"]["projector"]["serial"], "P-9");
    EXPECT_FALSE(rig["right_camera"].contains("serial"));
    EXPECT_NE(page.find("P-9"), std::string::npos);
    const fs::path capture = root / "room/captures/pose-01/capture.json";
    const std::string as_captured = whole(capture);
    const auto said = [&](const char* key, const json& value) {
        json settings = json::parse(as_captured);
        settings[key] = value;
        std::ofstream(capture) << settings.dump();
        return run_planlight("check room/captures/pose-01 --rig rig.json", root);
    };
    EXPECT_EQ(said("left_serial", "L-1").exit_code, 0);
    expect_refused(said("projector_serial", "P-10"), 6, "projector P-10, and the rig file is of P-9");
    expect_refused(run_planlight("scan room/captures/pose-01 --rig rig.json --out cloud.ply", root), 6, "P-10");
    expect_refused(run_planlight("calibrate room/captures" + board + " --serial-projector P-9 --out rig.json", root), 3,
                   "P-10");
    std::ofstream(capture) << as_captured;
    json wide = rig;
    wide["left_camera"]["width"] = 752;
    std::ofstream(root / "wide.json") << wide.dump();
    expect_refused(run_planlight("check room/captures/pose-01 --rig wide.json", root), 6,
                   "744 x 576 pixels here and 752 x 576");

    const std::string good = whole(root / "rig.json");
    fs::create_directories(root / "few");
    fs::copy(root / "room" / "captures" / "pose-00", root / "few" / "pose-00", fs::copy_options::recursive);
    expect_refused(run_planlight("calibrate few" + board + " --out rig.json", root), 6, "in 1 of 1 poses");
    expect_refused(run_planlight("calibrate room/captures --board 'chessboard 9x6 25 mm' --out rig.json", root), 6,
                   "chessboard 9x6");
    expect_refused(run_planlight("calibrate room/captures --board 'charuco' --out rig.json", root), 3, "charuco");
    expect_refused(run_planlight("calibrate nowhere" + board + " --out rig.json", root), 3, "nowhere");
    const fs::path missing = root / "room" / "captures" / "pose-02" / "right" / "row-phase-3.png";
    fs::rename(missing, root / "kept.png");
    expect_refused(run_planlight("calibrate room/captures" + board + " --out rig.json", root), 3, "row-phase-3");
    const fs::path other = root / "room" / "captures" / "pose-03" / "left" / "white.png";
    fs::rename(other, root / "other.png");
    expect_refused(run_planlight("calibrate room/captures" + board + " --out rig.json", root), 3,
                   "2 pictures are missing: pose-02/right/row-phase-3, pose-03/left/white");
    fs::rename(root / "other.png", other);
    std::ofstream(missing, std::ios::binary) << whole(root / "kept.png").substr(0, 5000);
    expect_refused(run_planlight("calibrate room/captures" + board + " --out rig.json", root), 4, "row-phase-3");
    EXPECT_EQ(whole(root / "rig.json"), good);

    // The other way to lay captures out: one capture.json for all, one camera, plain pictures.
    for (int pose = 0; pose < 4; ++pose) {
        const std::string name = "pose-0" + std::to_string(pose);
        fs::create_directories(root / "plain" / name);
        for (const char* side : {"left", "right"})
            fs::copy(root / "room" / "captures" / name / side / "white.png",
                     root / "plain" / name / (std::string(side) + ".png"));
    }
    const auto pair = run_planlight("calibrate plain" + board + " --out pair.json --json", root);
    ASSERT_EQ(pair.exit_code, 0) << pair.err;
    const json of_two = json::parse(std::ifstream(root / "pair.json"));
    EXPECT_FALSE(of_two.contains("projector"));
    EXPECT_TRUE(of_two.contains("right_camera"));
    EXPECT_FALSE(json::parse(pair.out)["devices"].contains("projector"));
    EXPECT_TRUE(json::parse(pair.out)["predicted_error"]["light_p95_mm"].is_null())
        << "there is no light: no figure of it, not 0";
    EXPECT_NEAR(json::parse(pair.out)["devices"]["left_camera"]["focal_x"].get<double>(),
                truth["left_camera"]["focal_x"].get<double>(), 10);
}

TEST(CalibrateCommand, AFolderThatIsNotThereIsSaidBeforeTheWork) {
    const TemporaryFolder folder;
    expect_refused(
        run_planlight("calibrate captures --board 'charuco 10x7 25 mm' --out nowhere/rig.json", folder.path()), 7,
        "Make the folder nowhere first");
    fs::create_directories(folder.path() / "rig.json");
    expect_refused(run_planlight("calibrate captures --board 'charuco 10x7 25 mm'", folder.path()), 7, "is a folder");
}

TEST(BoardCommand, WritesTheSheetTwice) {
    const TemporaryFolder folder;
    const auto run = run_planlight("board --board 'chessboard 9x6 20 mm' --out sheet --json", folder.path());
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(json::parse(run.out)["corners"], 54);
    EXPECT_TRUE(whole(folder.path() / "sheet.pdf").starts_with("%PDF"));
    EXPECT_TRUE(whole(folder.path() / "sheet.png").starts_with("\x89PNG"));
    ASSERT_EQ(run_planlight("board --board 'chessboard 9x6 20 mm' --out other.pdf", folder.path()).exit_code, 0);
    EXPECT_TRUE(fs::exists(folder.path() / "other.pdf"));
    expect_refused(run_planlight("board --board 'chessboard 999x999 1000 mm'", folder.path()), 3, "5 m is the most");
    expect_refused(run_planlight("board --board 'chessboard 9x6 2 cm'", folder.path()), 3, "mm");
}

TEST(SimulateCommand, NeedsAPatientOrABoard) {
    const TemporaryFolder folder;
    expect_refused(run_planlight("simulate --out room", folder.path()), 2, "neither a patient nor a board");
}

}  // namespace
}  // namespace planlight::test
