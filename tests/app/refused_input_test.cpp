#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/app/on_example_patient.h"

namespace planlight::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

TEST_F(CommandsTest, AMissingFileIsSaidSo) {
    expect_one_clear_sentence(run_planlight("prepare nowhere.inv3 --plan " + plan() + " --out new", root()), 3,
                              "nowhere.inv3");
    EXPECT_FALSE(fs::exists(root() / "new"));
}

TEST_F(CommandsTest, ATruncatedVolumeIsDamagedAndLeavesNothing) {
    fs::copy_file(*example_patient(), root() / "short.inv3", fs::copy_options::overwrite_existing);
    fs::resize_file(root() / "short.inv3", 3'000'000);
    expect_one_clear_sentence(run_planlight("prepare short.inv3 --plan " + plan() + " --out new", root()), 4,
                              "short.inv3");
    for (const auto& entry : fs::directory_iterator(root()))
        EXPECT_FALSE(entry.path().filename().string().starts_with("new")) << entry.path();
}

TEST_F(CommandsTest, APlanInAnUnknownFrameIsRefusedNotGuessed) {
    json odd = read_json(plan());
    odd["markups"][0]["coordinateSystem"] = "lps";  // 3D Slicer reads a mistyped frame as RAS without a word
    std::ofstream(root() / "odd.mrk.json") << odd;
    expect_one_clear_sentence(run_planlight("prepare " + patient() + " --plan odd.mrk.json --out new", root()), 3,
                              "lps");
}

TEST_F(CommandsTest, APlanReadInTheWrongFrameIsRefusedByNameAndLeavesNothing) {
    json turned = read_json(plan());
    for (auto& markup : turned["markups"]) markup["coordinateSystem"] = "RAS";  // turned by 180 degrees about z
    std::ofstream(root() / "turned.mrk.json") << turned;
    const auto run = run_planlight("prepare " + patient() + " --plan turned.mrk.json --out turned --json", root());
    expect_one_clear_sentence(run, 3, "does not fit this patient");
    for (const char* item : {"Osteotomy", "outside the volume"})
        EXPECT_NE(run.err.find(item), std::string::npos) << run.err;
    EXPECT_FALSE(fs::exists(root() / "turned"));
}

TEST_F(CommandsTest, ALutOfAnotherCaseIsRefused) {
    prepared();
    ASSERT_EQ(run_planlight("prepare " + patient() + " --plan " + plan() + " --threshold -200 --voxel-mm 2 --out other",
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
    prepared();
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
    simulated();
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

TEST_F(CommandsTest, LandmarksWithoutTheirSpaceAreAdvisedNothingThatRegisterDoesNotHave) {
    prepared();
    std::ofstream(root() / "bare.csv") << "name,ct_x,ct_y,ct_z,rig_x,rig_y,rig_z\nnose,1,2,3,4,5,6\n";
    const auto run = run_planlight("register case --pairs bare.csv --out never.json", root());
    expect_one_clear_sentence(run, 3, "does not say its coordinate system");
    EXPECT_EQ(run.err.find("--frame"), std::string::npos) << run.err;
}

TEST_F(CommandsTest, ACloudInAnotherUnitIsToldAsThat) {
    prepared();
    std::ofstream cloud(root() / "metres.ply");
    cloud << "ply\nformat ascii 1.0\nelement vertex 2000\nproperty float x\nproperty float y\nproperty float "
             "z\nend_header\n";
    for (int i = 0; i < 2000; ++i) cloud << 0.1 * std::cos(i) << ' ' << 0.1 * std::sin(i) << ' ' << 0.00005 * i << '\n';
    cloud.close();
    const auto run =
        run_planlight("register case --cloud metres.ply --in-rig --viewpoint 0 0 0 --out never.json", root());
    expect_one_clear_sentence(run, 3, "mm across if its numbers are mm");
    EXPECT_NE(run.err.find("--unit m,"), std::string::npos) << run.err;
}

TEST_F(CommandsTest, ACaseIsReplacedOnlyWhenThatIsSaid) {
    prepared();
    expect_one_clear_sentence(run_planlight("prepare " + patient() + " --plan " + plan() + " --out case", root()), 3,
                              "--replace");
}

/// A full disk behind it, or a terminal that has gone, is no reason to end in the middle, or by another exit code.
TEST_F(CommandsTest, AStandardErrorThatTakesNothingChangesNothing) {
    const auto code_of = [](const std::string& line) {
        const int status = std::system(line.c_str());
        return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    };
    const std::string program = "'" PLANLIGHT_PROGRAM "' ";
    for (const char* nowhere : {" 2>/dev/full", " 2>&-"}) {
        EXPECT_EQ(code_of(program + "plan /nowhere/plan.mrk.json" + nowhere), 3) << nowhere;
        EXPECT_EQ(code_of(program + "plan '" + plan() + "' >/dev/null" + nowhere), 0) << nowhere;
    }
    // The first file that is opened would take the number of standard error, and a log stays open.
    const auto log_of = [&](const std::string& name, const std::string& where) {
        EXPECT_EQ(
            code_of(program + "plan '" + plan() + "' --log-file '" + (root() / name).string() + "' >/dev/null" + where),
            0);
        const std::string text = read_text(root() / name);
        return std::count(text.begin(), text.end(), '\n');
    };
    const auto lines = log_of("closed.log", " 2>&-");
    EXPECT_EQ(lines, log_of("open.log", " 2>/dev/null")) << "what is said to a person stands in the log";
    EXPECT_GE(lines, 3) << "begin, a warning, end";
}

TEST_F(CommandsTest, ALogIsAddedToLogsOnly) {
    const fs::path log = root() / "some.log", other = root() / "notes.txt";
    std::ofstream(other) << "Not a log, and of value to somebody.\n";
    const std::string before = read_text(other);
    for (int run = 0; run < 2; ++run)
        EXPECT_EQ(run_planlight("plan " + plan() + " --log-file some.log", root()).exit_code, 0) << run;
    EXPECT_GT(read_text(log).size(), 0u);
    EXPECT_EQ(run_planlight("plan " + plan() + " --log-file " + plan(), root()).exit_code, 2) << "an input";
    expect_one_clear_sentence(run_planlight("plan " + plan() + " --log-file notes.txt", root()), 3, "no log");
    EXPECT_EQ(read_text(other), before);
}

TEST_F(CommandsTest, WrongUsageGivesExitTwo) {
    EXPECT_EQ(run_planlight("prepare", root()).exit_code, 2);
    EXPECT_EQ(run_planlight("prepare " + patient() + " --plan " + plan() + " --voxel-mm nan --out n", root()).exit_code,
              2);
    for (const char* level : {"nan", "inf", "-NaN"})
        EXPECT_EQ(
            run_planlight("prepare " + patient() + " --plan " + plan() + " --threshold " + level + " --out n", root())
                .exit_code,
            2)
            << level;
    const auto frame = run_planlight("project case --rig r.json --registration m.json --frame 3 --out l.png", root());
    EXPECT_EQ(frame.exit_code, 2);
    EXPECT_NE(frame.err.find("--poses"), std::string::npos) << frame.err;
    EXPECT_EQ(run_planlight("nonsense", root()).exit_code, 2);
    EXPECT_EQ(run_planlight("demo --preset both --seeds -3", root()).exit_code, 2);
}

TEST_F(CommandsTest, EveryCommandExplainsItselfWithAnExample) {
    for (const char* name : {"demo", "prepare", "plan", "patterns", "scan", "register", "track", "project", "session",
                             "review", "simulate", "board", "calibrate", "check", "projector", "merge"}) {
        const auto run = run_planlight(std::string(name) + " --help", root());
        EXPECT_EQ(run.exit_code, 0) << name;
        EXPECT_NE(run.out.find("Example:"), std::string::npos) << name;
    }
}

TEST_F(CommandsTest, AWindowWithoutADisplayIsADeviceError) {
    if (std::getenv("DISPLAY")) GTEST_SKIP() << "there is a display";
    prepared();
    const auto run = run_planlight("review case", root());
    expect_one_clear_sentence(run, 5, "--picture");
    const auto session = run_planlight("session case --volume '" + patient() + "'", root());
    EXPECT_EQ(session.exit_code, 5) << session.err;
    EXPECT_NE(session.err.find("Display"), std::string::npos) << session.err;
    EXPECT_FALSE(std::filesystem::exists(root() / "case" / "recordings"))
        << "nothing happened, and nothing is recorded";
}

}  // namespace
}  // namespace planlight::test
