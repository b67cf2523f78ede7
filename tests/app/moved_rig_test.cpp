// A rig that moved, and files that do not belong together, through the commands.
#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "planning_io/case/rig_file.h"
#include "planning_io/files/image_file.h"
#include "planning_io/files/safe_write.h"
#include "tests/app/on_example_patient.h"

namespace planlight::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class MovedRig : public CommandsTest {
protected:
    /// rig.json as it would be if this device had been bumped since it was written.
    static void write_bumped(RigDevice device, const Eigen::Vector3d& turn_deg, const Eigen::Vector3d& shift_mm,
                             const std::string& name) {
        RigCalibration rig = read_rig(root() / "room" / "rig.json");
        DeviceChange change = DeviceChange::Zero();
        change.head<3>() = turn_deg * M_PI / 180;
        change.segment<3>(3) = shift_mm;
        CameraModel& model = device_of(rig, device);
        model = changed(model, change);
        write_rig(rig, root() / name);
    }

    static CommandRun run(const std::string& arguments) { return run_planlight(arguments, root()); }

    /// The chain on the room's capture with this rig.json; the last that was run. What the light is goes to NAME.png.
    static CommandRun chain(const std::string& rig, const std::string& name) {
        fs::remove(root() / (name + ".png"));
        CommandRun step = run("scan room/capture --rig " + rig + " --out " + name + ".ply");
        if (step.exit_code == 0) step = run("register case --cloud " + name + ".ply --out " + name + ".json");
        if (step.exit_code == 0)
            step = run("project case --rig " + rig + " --registration " + name + ".json --out " + name + ".png");
        return step;
    }

    /// With the rig as it was calibrated: good.ply, good.json, good.png.
    static void chain_of_the_good_rig() {
        static const CommandRun done = chain("room/rig.json", "good");
        ASSERT_EQ(done.exit_code, 0) << done.err;
    }

    /// Middle of all light, projector pixels.
    static Eigen::Vector2d middle_of(const fs::path& picture) {
        const GrayImage light = read_gray(picture);
        Eigen::Vector2d sum = Eigen::Vector2d::Zero();
        double weight = 0;
        for (int y = 0; y < light.height; ++y)
            for (int x = 0; x < light.width; ++x) {
                sum += light.at(x, y) * Eigen::Vector2d(x, y);
                weight += light.at(x, y);
            }
        return sum / weight;
    }
};

/// The projector's pixels are what lights the skin: whatever rig.json says, the same pixels must be lit. A tenth of a
/// degree is 4 of them, 1.6 mm.
TEST_F(MovedRig, LightOfABumpedProjectorFallsWhereItFellBefore) {
    prepared();
    simulated();
    ASSERT_NO_FATAL_FAILURE(chain_of_the_good_rig());
    const Eigen::Vector2d wanted = middle_of(root() / "good.png");
    int number = 0;
    for (const auto& [turn, shift] : {std::pair{Eigen::Vector3d(0.1, 0, 0), Eigen::Vector3d(0, 0, 0)},
                                      std::pair{Eigen::Vector3d(0.15, -0.2, 0.3), Eigen::Vector3d(0, 0, 0)},
                                      std::pair{Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.5, 1, 0)}}) {
        const std::string name = fmt::format("bumped{}", ++number);
        write_bumped(RigDevice::projector, turn, shift, name + "-rig.json");
        const auto lit = chain(name + "-rig.json", name);
        ASSERT_EQ(lit.exit_code, 0) << lit.err;
        EXPECT_NE(lit.err.find("the projector moved"), std::string::npos) << lit.err;
        EXPECT_LT((middle_of(root() / (name + ".png")) - wanted).norm(), 0.5) << "0.2 mm on the skin";
        const auto check = run("check room/capture --rig " + name + "-rig.json");
        EXPECT_EQ(check.exit_code, 6);
        EXPECT_NE(check.err.find("the projector moved"), std::string::npos) << check.err;
        EXPECT_NE(check.err.find("light drawn with the rig as it stands now"), std::string::npos) << check.err;
    }
}

TEST_F(MovedRig, LightOfABumpedCameraFallsWhereItFellBeforeOrThereIsNone) {
    prepared();
    simulated();
    ASSERT_NO_FATAL_FAILURE(chain_of_the_good_rig());
    const Eigen::Vector2d wanted = middle_of(root() / "good.png");
    int number = 0;
    for (const Eigen::Vector3d& turn : {Eigen::Vector3d(0.1, 0, 0), Eigen::Vector3d(0, 0.05, 0),
                                        Eigen::Vector3d(0, 0.3, 0), Eigen::Vector3d(0, -1, 0)}) {
        const std::string name = fmt::format("camera{}", ++number);
        write_bumped(RigDevice::left_camera, turn, {0, 0, 0}, name + "-rig.json");
        const auto lit = chain(name + "-rig.json", name);
        if (lit.exit_code == 6) {
            EXPECT_FALSE(fs::exists(root() / (name + ".png")));
            EXPECT_NE(lit.err.find("alibrate the rig again"), std::string::npos) << lit.err;
            continue;
        }
        ASSERT_EQ(lit.exit_code, 0) << lit.err;
        EXPECT_LT((middle_of(root() / (name + ".png")) - wanted).norm(), 1)
            << "0.4 mm on the skin: " << turn.transpose();
    }
}

TEST_F(MovedRig, PosesAreMeasuredWithTheRigThatTheScanFound) {
    prepared();
    simulated();
    write_bumped(RigDevice::right_camera, {0.2, 0.05, 0}, {0, 0, 0}, "right-rig.json");
    ASSERT_EQ(chain("right-rig.json", "right").exit_code, 0);
    ASSERT_NO_FATAL_FAILURE(chain_of_the_good_rig());
    const auto good = run("track room/frames --rig room/rig.json --capture room/capture --out good-poses.json");
    ASSERT_EQ(good.exit_code, 0) << good.err;
    const auto draw = [&](const std::string& rig, const std::string& match, const std::string& poses,
                          const std::string& out) {
        return run("project case --rig " + rig + " --registration " + match + " --poses " + poses + " --out " + out);
    };
    ASSERT_EQ(draw("room/rig.json", "good.json", "good-poses.json", "good-moved.png").exit_code, 0);
    for (const std::string by : {"--capture room/capture", "--capture room/capture --registration right.json"}) {
        const auto track = run("track room/frames --rig right-rig.json " + by + " --out right-poses.json");
        ASSERT_EQ(track.exit_code, 0) << track.err;
        const auto lit = draw("right-rig.json", "right.json", "right-poses.json", "right-moved.png");
        ASSERT_EQ(lit.exit_code, 0) << lit.err;
        EXPECT_NE(lit.err.find("the light of recorded poses was not measured"), std::string::npos) << lit.err;
        EXPECT_LT((middle_of(root() / "right-moved.png") - middle_of(root() / "good-moved.png")).norm(), 1);
    }
}

TEST_F(MovedRig, FilesOfOthersAreRefusedWithBothNames) {
    prepared();
    simulated();
    ASSERT_NO_FATAL_FAILURE(chain_of_the_good_rig());
    ASSERT_EQ(run("simulate " + patient() + " --plan " + plan() + " --preset paper --seed 5 --frames 1 --out room2")
                  .exit_code,
              0);
    ASSERT_EQ(
        run("prepare " + patient() + " --plan " + plan() + " --threshold -200 --voxel-mm 2 --out case2").exit_code, 0);
    const auto project = [&](const std::string& arguments) {
        fs::remove(root() / "never.png");
        const auto done = run("project " + arguments + " --out never.png");
        EXPECT_FALSE(fs::exists(root() / "never.png")) << arguments;
        return done;
    };
    expect_one_clear_sentence(project("case --rig room2/rig.json --registration good.json"), 3,
                              "and room2/rig.json is rig");
    expect_one_clear_sentence(project("case2 --rig room/rig.json --registration good.json"), 3, "is a match of case");
    ASSERT_EQ(run("track room2/frames --rig room2/rig.json --capture room2/capture --out poses2.json").exit_code, 0);
    expect_one_clear_sentence(project("case --rig room/rig.json --registration good.json --poses poses2.json"), 3,
                              "poses of rig");
    const auto other = run("track room/frames --rig room/rig.json --out first-frame.json");
    ASSERT_EQ(other.exit_code, 0) << other.err;
    const std::string first_frame = "case --rig room/rig.json --registration good.json --poses first-frame.json";
    expect_one_clear_sentence(project(first_frame), 6, "begin at its first frame");
    const auto drawn = run("project " + first_frame + " --confirmed --out lit.png");
    EXPECT_EQ(drawn.exit_code, 0) << drawn.err;
    EXPECT_NE(drawn.err.find("begin at its first frame"), std::string::npos) << drawn.err;
    expect_one_clear_sentence(run("review case2 --registration good.json --picture never.png"), 3,
                              "is a match of case");
    ASSERT_EQ(run("scan room2/capture --rig room2/rig.json --out other.ply").exit_code, 0);
    expect_one_clear_sentence(run("export case --registration good.json --cloud other.ply --slicer never"), 3,
                              "is the scan of capture");
    expect_one_clear_sentence(run("review case --registration good.json --cloud other.ply --picture never.png"), 3,
                              "is the scan of capture");
    fs::create_directories(root() / "hospital");
    fs::copy(root() / "room" / "rig.json", root() / "hospital" / "rig.json");
    const std::string rig = read_text(root() / "hospital" / "rig.json");
    expect_one_clear_sentence(run("simulate " + patient() + " --preset paper --seed 9 --frames 0 --out hospital"), 3,
                              "of no simulated room");
    EXPECT_EQ(read_text(root() / "hospital" / "rig.json"), rig);
    const std::string of_room2 = read_text(root() / "room2" / "rig.json");
    expect_one_clear_sentence(run("simulate " + patient() + " --preset paper --seed 9 --frames 0 --out room2"), 3,
                              "exists already and is not empty");
    EXPECT_EQ(read_text(root() / "room2" / "rig.json"), of_room2) << "another room's beside this capture";
}

TEST_F(MovedRig, FramesOfExchangedCamerasOrOfAnotherRigAreNamed) {
    prepared();
    simulated();
    ASSERT_EQ(run("simulate " + patient() + " --plan " + plan() + " --preset paper --seed 6 --frames 1 --out room6")
                  .exit_code,
              0);
    fs::copy(root() / "room" / "frames", root() / "exchanged", fs::copy_options::recursive);
    fs::rename(root() / "exchanged" / "left", root() / "exchanged" / "was-left");
    fs::rename(root() / "exchanged" / "right", root() / "exchanged" / "left");
    fs::rename(root() / "exchanged" / "was-left", root() / "exchanged" / "right");
    const auto track = [](const std::string& arguments) { return run("track " + arguments + " --out never.json"); };
    expect_one_clear_sentence(track("exchanged --rig room/rig.json --capture room/capture"), 6,
                              "in the frames left and right camera are exchanged");
    expect_one_clear_sentence(track("exchanged --rig room/rig.json"), 6, "seems to be the right one's");
    expect_one_clear_sentence(track("room/frames --rig room6/rig.json"), 6, "the rig is not that of these pictures");
    EXPECT_FALSE(fs::exists(root() / "never.json"));
}

/// Its poses agree as before, and are wrong: the left camera was knocked by two pixels sideways since the scan.
TEST_F(MovedRig, FramesOfACameraThatWasKnockedSinceTheScanAreWarnedOf) {
    prepared();
    simulated();
    fs::copy(root() / "room" / "frames", root() / "knocked", fs::copy_options::recursive);
    for (const auto& entry : fs::directory_iterator(root() / "knocked" / "left")) {
        const GrayImage as_seen = read_gray(entry.path());
        GrayImage moved = as_seen;
        for (int y = 0; y < moved.height; ++y)
            for (int x = 2; x < moved.width; ++x) moved.at(x, y) = as_seen.at(x - 2, y);
        write_png(moved, entry.path());
    }
    const auto track = [](const std::string& frames) {
        return run("track " + frames + " --rig room/rig.json --capture room/capture --out poses-of-it.json");
    };
    const auto before = track("room/frames"), after = track("knocked");
    EXPECT_EQ(before.exit_code, 0) << before.err;
    EXPECT_EQ(before.err.find("fit the cameras worse"), std::string::npos) << before.err;
    EXPECT_EQ(after.exit_code, 0) << after.err;
    EXPECT_NE(after.err.find("fit the cameras worse than in the scan"), std::string::npos) << after.err;
}

TEST_F(MovedRig, AnEditedMatchAndLightThatFallsNowhereAreRefused) {
    prepared();
    simulated();
    ASSERT_NO_FATAL_FAILURE(chain_of_the_good_rig());
    std::string text = read_text(root() / "good.json");
    text.replace(text.find("\"residual_rms_mm\": 0."), 21, "\"residual_rms_mm\": 1.");
    std::ofstream(root() / "edited.json") << text;
    expect_one_clear_sentence(run("project case --rig room/rig.json --registration edited.json --out never.png"), 4,
                              "checksum");
    json poses = {{"format", "planlight poses"}, {"version", 1}};
    poses["poses"] = json::array({{{"at_ns", 0},
                                   {"rig_from_patient", {1, 0, 0, 900, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}},
                                   {"markers_left", 5},
                                   {"markers_right", 5},
                                   {"residual_px", 0.1},
                                   {"predicted_error_mm", 0.1},
                                   {"reason", ""}}});
    std::ofstream(root() / "away.json") << poses;
    const std::string away =
        "project case --rig room/rig.json --registration good.json --poses away.json --out never.png";
    expect_one_clear_sentence(run(away), 6, "does not say with which rig and from which scan its poses are");
    EXPECT_EQ(run(away + " --confirmed --frame -1").exit_code, 2) << "there is none before the first";
    const auto dark = run(away + " --confirmed");
    EXPECT_EQ(dark.exit_code, 6) << dark.err;
    EXPECT_NE(dark.err.find("nothing of the plan lies in the projector's light"), std::string::npos) << dark.err;
    EXPECT_FALSE(fs::exists(root() / "never.png"));
}

/// A cloud without names is the cloud of another scanner: it is matched, and drawn only on a person's word.
TEST_F(MovedRig, ACloudWithoutARigIsMatchedAndDrawnOnlyOnAPersonsWord) {
    prepared();
    simulated();
    ASSERT_NO_FATAL_FAILURE(chain_of_the_good_rig());
    std::string text = read_text(root() / "good.ply");
    for (std::size_t at; (at = text.find("comment PLANLIGHT-RIG")) != std::string::npos;)
        text.erase(at, text.find('\n', at) + 1 - at);
    std::ofstream(root() / "nameless.ply", std::ios::binary) << text;
    const auto match = run("register case --cloud nameless.ply --out nameless.json --json");
    ASSERT_EQ(match.exit_code, 0) << match.err;
    EXPECT_EQ(json::parse(match.out)["verdict"], "yes");
    const std::string project = "project case --rig room/rig.json --registration nameless.json --out nameless.png";
    EXPECT_EQ(run(project).exit_code, 6);
    const auto drawn = run(project + " --confirmed");
    EXPECT_EQ(drawn.exit_code, 0) << drawn.err;
    EXPECT_NE(drawn.err.find("does not say with which rig"), std::string::npos) << drawn.err;
}

}  // namespace
}  // namespace planlight::test
