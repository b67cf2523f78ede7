#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "planning_io/case/capture_folder.h"
#include "planning_io/case/frames_folder.h"
#include "registration/scan/pattern/stripe_patterns.h"
#include "tests/app/run_command.h"
#include "tests/support/test_data.h"

namespace planlight::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using std::chrono::milliseconds;

/// Bars from 60 to 180, and a row that is saturated.
GrayImage picture(int bar) {
    GrayImage picture(160, 120, 60);
    for (int y = 0; y < 120; ++y)
        for (int x = 0; x < 160; ++x) picture.at(x, y) = y == 0 ? 255 : x / bar % 2 == 1 ? 180 : 60;
    return picture;
}

/// Ten frames every 40 ms; the right camera is less sharp.
void write_recorded_room(const fs::path& root, const std::string& recorded) {
    std::vector<StereoFrame> frames(10);
    for (std::size_t i = 0; i < frames.size(); ++i) {
        frames[i].left = picture(4);
        frames[i].right = picture(16);
        frames[i].at = milliseconds(40) * static_cast<int>(i);
        frames[i].exposure = milliseconds(10);
        frames[i].number = i;
    }
    write_frames(frames, root / "frames");
    CaptureFolder capture;
    capture.projector_width = 64;
    capture.projector_height = 48;
    StripeSettings stripes;
    stripes.width = 64, stripes.height = 48;
    for (const StripePattern& pattern : stripe_sequence(stripes)) {
        capture.names.push_back(pattern.name);
        capture.left.push_back(picture(8));
        capture.right.push_back(picture(8));
    }
    write_capture(capture, root / "capture");
    std::ofstream(root / "room.json")
        << R"({"format": "planlight room", "version": 1, "rig": "rig.json", "cameras": {"recorded": {)" << recorded
        << "}}}";
}

TEST(CamerasCommand, PrintsTheFiguresOfARecordedRoomWithoutAWindow) {
    const TemporaryFolder folder;
    write_recorded_room(folder.path(), R"("frames": "frames", "capture": "capture")");
    const CommandRun run = run_planlight("cameras --room room.json --json --seconds 2 --show star", folder.path());
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const json figures = json::parse(run.out);
    const json &left = figures["left"], &right = figures["right"];
    EXPECT_EQ(left["width"], 160);
    EXPECT_DOUBLE_EQ(left["exposure_ms"].get<double>(), 10);
    EXPECT_NEAR(left["frames_hz"].get<double>(), 25, 2) << "40 ms apart; of two seconds a frame or two more or less";
    EXPECT_GT(left["sharpness"].get<double>(), 1.5 * right["sharpness"].get<double>()) << "four times as many edges";
    EXPECT_NEAR(left["too_bright_percent"].get<double>(), 100 / 120.0, 1e-6);
    EXPECT_EQ(left["lost"], 0);
    EXPECT_EQ(figures["together"], true);
    EXPECT_EQ(figures["apart_ms"].get<double>(), 0);
    EXPECT_EQ(figures["shown"], "star");
    const CommandRun words = run_planlight("cameras --room room.json --headless --seconds 0.5", folder.path());
    EXPECT_EQ(words.exit_code, 0) << words.err;
    EXPECT_NE(words.out.find("Left camera: 160 x 120 pixels"), std::string::npos) << words.out;
    EXPECT_NE(words.out.find("expose together"), std::string::npos);
}

TEST(CamerasCommand, RefusesWhatIsNoRecordingAndLightThatNobodyHas) {
    const TemporaryFolder folder;
    write_recorded_room(folder.path(), R"("frames": "frames")");
    expect_refused(run_planlight("cameras --room room.json --json --show star", folder.path()), 5,
                   "neither a monitor nor a scan");
    fs::remove(folder.path() / "frames/right/000003.png");
    expect_refused(run_planlight("cameras --room room.json --json", folder.path()), 3, "000003.png");
    expect_refused(run_planlight("cameras --room room.json --show stars", folder.path()), 2, "stars");
    expect_refused(run_planlight("cameras --room nowhere.json", folder.path()), 3, "nowhere.json");
}

TEST(CamerasCommand, TheScanOfARecordedRoomIsCapturedAsItWasRecorded) {
    const TemporaryFolder folder;
    write_recorded_room(folder.path(), R"("frames": "frames", "capture": "capture", "pace": "fastest")");
    const CommandRun run = run_planlight("capture --room room.json --out again --json", folder.path());
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const CaptureFolder was = read_capture(folder.path() / "capture"), is = read_capture(folder.path() / "again");
    EXPECT_EQ(is.names, was.names);
    for (std::size_t i = 0; i < was.left.size(); ++i) {
        EXPECT_EQ(is.left.at(i).pixels, was.left[i].pixels) << was.names[i];
        EXPECT_EQ(is.right.at(i).pixels, was.right[i].pixels) << was.names[i];
    }
}

TEST(CamerasCommand, TheDoctorSaysThatARecordingIsNoRoom) {
    const TemporaryFolder folder;
    write_recorded_room(folder.path(), R"("frames": "frames", "capture": "capture")");
    const CommandRun run = run_planlight("doctor --room room.json --json", folder.path());
    const json figures = json::parse(run.out);
    bool said = false;
    for (const json& line : figures["lines"])
        said = said || (line["subject"] == "cameras, recorded" && line["health"] == "look");
    EXPECT_TRUE(said) << run.out;
}

}  // namespace
}  // namespace planlight::test
