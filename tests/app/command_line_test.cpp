#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/app/run_command.h"

namespace planlight::test {
namespace {

namespace fs = std::filesystem;

/// A folder of its own, which is also the home of settings.
class CommandLineTest : public testing::Test {
protected:
    CommandLineTest() : folder_(fs::temp_directory_path() / ("planlight-line-" + std::to_string(::getpid()))) {
        fs::remove_all(folder_);
        fs::create_directories(folder_);
        ::setenv("XDG_CONFIG_HOME", (folder_ / "settings").c_str(), 1);
    }
    ~CommandLineTest() override { fs::remove_all(folder_); }
    CommandRun run(const std::string& arguments) const { return run_planlight(arguments, folder_); }
    /// The same with a terminal for standard output and error, both in `out`.
    CommandRun run_on_a_terminal(const std::string& arguments) const {
        const std::string line = "cd '" + folder_.string() + "' && script -qec \"'" PLANLIGHT_PROGRAM "' " + arguments +
                                 "\" /dev/null > .terminal < /dev/null";
        CommandRun run;
        run.exit_code = std::system(line.c_str());
        run.out = whole(folder_ / ".terminal");
        return run;
    }
    void write_settings(const std::string& text) const {
        fs::create_directories(folder_ / "settings/planlight");
        std::ofstream(folder_ / "settings/planlight/config.json") << text;
    }
    fs::path folder_;
};

TEST_F(CommandLineTest, AMistypedOptionIsToldTheNearestOne) {
    expect_refused(run("register --hlep"), 2, "--help");
    expect_refused(run("register case --clod cloud.ply --out r.json"), 2, "Is --cloud meant?");
    expect_refused(run("--hlep"), 2, "Is --help meant?");
    expect_refused(run("patterns --out p --phase_steps 8"), 2, "Is --phase-steps meant?");
}

TEST_F(CommandLineTest, WhatIsReadIsNeverWrittenOver) {
    fs::create_directories(folder_ / "frames" / "left");
    fs::create_directories(folder_ / "case");
    for (const char* name : {"rig.json", "cloud.ply", "frames/frames.json", "frames/left/000000.png", "case/case.json"})
        std::ofstream(folder_ / name) << "kept";
    fs::create_symlink("rig.json", folder_ / "link.json");
    for (const std::string line :
         {"scan capture --rig rig.json --out rig.json", "scan capture --rig rig.json --out ./case/../rig.json",
          "scan capture --rig link.json --out rig.json", "register case --cloud cloud.ply --out cloud.ply",
          "register case --cloud cloud.ply --out case/case.json",
          "track frames --rig rig.json --out frames/frames.json",
          "track frames --rig rig.json --out frames/left/000000.png"})
        expect_refused(run(line), 2, "would be written over");
    expect_refused(run("register case --cloud cloud.ply --out r.json --certificate r.json"), 2, "name the same file");
    expect_refused(run("scan capture --rig rig.json --out s.ply --surface s.ply"), 2, "name the same file");
    fs::create_directories(folder_ / "paper");
    EXPECT_EQ(run("simulate volume.nii --preset paper --out paper").err.find("written over"), std::string::npos)
        << "a preset is no folder";
    for (const char* name : {"rig.json", "cloud.ply", "frames/frames.json", "case/case.json"})
        EXPECT_EQ(whole(folder_ / name), "kept") << name;
}

TEST_F(CommandLineTest, APdfIsCalledSoAndStandsWhereItCanBeWritten) {
    for (const std::string line :
         {"prepare volume.nii --plan p.fcsv --out case", "register case --cloud c.ply --out r.json",
          "calibrate captures --board 'charuco 10x7 25 mm'", "projector recording",
          "demo --headless --volume volume.nii"}) {
        expect_refused(run(line + " --pdf page.html"), 3, "page.html");
        EXPECT_NE(run(line.substr(0, line.find(' ')) + " --help").out.find("--pdf"), std::string::npos) << line;
    }
    expect_refused(run("projector --identify --pdf page.pdf"), 2, "--pdf");
    expect_refused(run("projector recording --pdf none/page.pdf"), 7, "none");
}

TEST_F(CommandLineTest, OptionsThatDoNotMakeAWholeQuestionAreAMatterOfUsage) {
    expect_refused(run("projector"), 2, "nothing to measure");
    expect_refused(run("projector --show --keep light"), 2, "--monitor");
    expect_refused(run("projector --show --monitor HDMI-2"), 2, "--keep");
    expect_refused(run("simulate --board 'charuco 10x7 25 mm' --serve HDMI-2 --addresses 127.0.0.1 --out room"), 2,
                   "one for each camera");
    expect_refused(run("patterns --set fast --phase-steps 9 --out p"), 2, "its own number of shifts");
    expect_refused(run("patterns --set multi-frequency --phase-period-px 20 --out p"), 2, "its own periods");
    for (const char* name : {"light", "room", "p"}) EXPECT_FALSE(fs::exists(folder_ / name)) << name;
}

TEST_F(CommandLineTest, JsonIsNoPartOfWhatIsDoneInAWindow) {
    expect_refused(run("review case --cloud cloud.ply --landmarks pairs.csv --json"), 2,
                   "--landmarks and --json cannot be given both");
    expect_refused(run("replay session.plrec --show --json"), 2, "--show and --json cannot be given both");
}

// A shell makes nothing of a variable that is not set; the work must not go on as if the option were not there.
TEST_F(CommandLineTest, AnOptionThatIsGivenEmptyIsNoOptionThatIsLeftOut) {
    for (const std::string line :
         {"prepare volume.nii --plan p.fcsv --out case --surface ''",
          "project case --rig r.json --registration r --poses '' --out l.png", "plan p.fcsv --case ''",
          "register case --cloud c.ply --out ''", "board --out ''", "plan p.fcsv --log-file ''"})
        expect_refused(run(line), 2, "is given, and empty");
    EXPECT_FALSE(fs::exists(folder_ / ".png"));
}

TEST_F(CommandLineTest, WhatACaseIsMadeOfIsNotWrittenOverByWhoDoesNotReadIt) {
    fs::create_directories(folder_ / "theirs");
    for (const char* name : {"case.json", "checksums.xxh128", "skin.ply", "plan.mrk.json"})
        std::ofstream(folder_ / "theirs" / name) << "kept";
    expect_refused(run("scan capture --rig rig.json --out theirs/skin.ply"), 2, "a file that the case in its folder");
    expect_refused(run("plan other.csv --frame LPS --out theirs/plan.mrk.json"), 2, "a file that the case");
    EXPECT_EQ(whole(folder_ / "theirs/skin.ply"), "kept");
    EXPECT_EQ(run("plan other.csv --frame LPS --out theirs/mine.mrk.json").err.find("a file that the case"),
              std::string::npos);
}

TEST_F(CommandLineTest, WhereOneOfItsFilesCannotStandNoneIsWritten) {
    for (const std::string line : {"register case --cloud c.ply --out r.json --certificate none/c.html",
                                   "register case --cloud c.ply --out r.json --slicer none/t.tfm",
                                   "scan capture --rig rig.json --out c.ply --raw none/raw.ply",
                                   "scan capture --rig rig.json --out c.ply --surface none/s.ply"})
        expect_refused(run(line), 7, "none");  // before anything is read: none of it is there
}

TEST_F(CommandLineTest, AReportIsOfARecording) {
    expect_refused(run("report none/none.plrec"), 3, "Name a recording");
    std::ofstream(folder_ / "plan.json") << "{}";
    expect_refused(run("report plan.json"), 3, "is no recording of a session");
}

TEST_F(CommandLineTest, AMistypedCommandIsToldTheNearestOne) {
    expect_refused(run("regsiter case"), 2, "Is register meant?");
    expect_refused(run("Demo"), 2, "Is demo meant?");
    const auto nothing_like_it = run("foo");  // no command is near: all of them are said
    for (const char* command : {"\"foo\" is no command", "demo", "prepare", "simulate"})
        expect_refused(nothing_like_it, 2, command);
}

TEST_F(CommandLineTest, TheHelpThatIsAdvisedIsThatOfTheCommand) {
    expect_refused(run("register"), 2, "Run `planlight register --help`.");
    expect_refused(run("patterns --width many --out p"), 2, "Run `planlight patterns --help`.");
    expect_refused(run("patterns --set slow --out p"), 2, "Run `planlight patterns --help`.");
    expect_refused(run(""), 2, "Run `planlight --help`.");
    expect_refused(run("board one two"), 2, "one argument too many");
}

TEST_F(CommandLineTest, WhatAnOptionTakesIsSaidInWordsForPeople) {
    const CommandRun mistyped = run("patterns --set faast --out p");
    expect_refused(mistyped, 2, "--set: \"faast\" is not ");
    expect_refused(mistyped, 2, "Is fast meant?");
    expect_refused(run("simulate --seed 99999999999999999999999 --out s"), 2, "is no number that it takes.");
    expect_refused(run("patterns --width many --out p"), 2, "--width: \"many\" is no number from 64 to 8192.");
    expect_refused(run("patterns --width 9 --out p"), 2, "--width: \"9\" is no number from 64 to 8192.");
    expect_refused(run("patterns --width"), 2, "--width takes one value, and not all were given.");
    expect_refused(run("patterns --width 64 --width 65 --out p"), 2, "--width takes one value, and 2 were given.");
    expect_refused(run("board --quiet --verbose"), 2, "cannot be given both.");
    const CommandRun endless = run("patterns --out p --set " + std::string(100'000, 'a'));
    expect_refused(endless, 2, "... Run `planlight patterns --help`.");
    EXPECT_LT(endless.err.size(), 500U);
}

TEST_F(CommandLineTest, HelpThatCouldNotBePrintedIsNoSuccess) {
    for (const char* asked : {"--help", "register --help", "--version"})
        EXPECT_EQ(WEXITSTATUS(std::system(
                      ("'" PLANLIGHT_PROGRAM "' " + std::string(asked) + " > /dev/full 2> /dev/null").c_str())),
                  7)
            << asked;
}

TEST_F(CommandLineTest, ALanguageThatIsNotThereIsRefusedAlsoWhereNoWindowOpens) {
    const CommandRun unknown = run("review case --json --language xx");
    expect_refused(unknown, 3, "xx");
    expect_refused(unknown, 3, "language");
    expect_refused(run("review case --json --language de"), 3, "case");
}

TEST_F(CommandLineTest, ItemsThatNobodyCouldTellApartAreToldBeforeThereIsACase) {
    std::ofstream(folder_ / "two.csv") << "name,entry_x,entry_y,entry_z,target_x,target_y,target_z\n"
                                          "A,0,0,0,10,10,10\nA,5,5,0,10,10,10\n";
    const auto listed = run("plan two.csv --frame LPS --json");
    EXPECT_EQ(listed.exit_code, 0) << listed.err;
    EXPECT_NE(listed.err.find("another item has the same name"), std::string::npos) << listed.err;
    EXPECT_EQ(nlohmann::json::parse(listed.out).at("warnings").size(), 2U) << listed.out;
}

TEST_F(CommandLineTest, AResultBeginsOnItsOwnLineAfterTheBar) {
    const auto done = run_on_a_terminal("patterns --width 64 --height 64 --out p");
    EXPECT_EQ(done.exit_code, 0) << done.out;
    const auto bar = done.out.rfind("100 %"), result = done.out.find("patterns of 64 x 64");
    ASSERT_NE(bar, std::string::npos) << done.out;
    ASSERT_NE(result, std::string::npos) << done.out;
    EXPECT_NE(done.out.substr(bar, result - bar).find('\n'), std::string::npos) << done.out;
}

TEST_F(CommandLineTest, QuietSaysNothingButWhatJsonPrints) {
    const auto quiet = run("board --quiet");
    EXPECT_EQ(quiet.exit_code, 0);
    EXPECT_EQ(quiet.out + quiet.err, "");
    EXPECT_TRUE(fs::exists(folder_ / "board.pdf"));
    EXPECT_EQ(nlohmann::json::parse(run("board --quiet --json").out)["png"], "board.png");
    expect_refused(run("board --quiet --board nonsense"), 3, "nonsense");  // a refusal is said all the same
}

TEST_F(CommandLineTest, VerboseSaysEveryStepWithItsTime) {
    const auto talkative = run("patterns --width 64 --height 64 --out p --verbose");
    EXPECT_NE(talkative.err.find("patterns: 0."), std::string::npos) << talkative.err;
    EXPECT_EQ(run("board --quiet --verbose").exit_code, 2);
}

TEST_F(CommandLineTest, TheLogFileKeepsCommandStepsRefusalAndExitCode) {
    ASSERT_EQ(run("patterns --width 64 --height 64 --out p --log-file log.txt").exit_code, 0);
    ASSERT_EQ(run("patterns --width 64 --height 64 --out p --log-file log.txt").exit_code, 3);  // p is there already
    const std::string log = whole(folder_ / "log.txt");
    for (const char* kept : {"patterns --width 64", "patterns: 0.", "exit 0", "exists already", "exit 3"})
        EXPECT_NE(log.find(kept), std::string::npos) << kept << " not in:\n" << log;
    expect_refused(run("board --log-file nowhere/log.txt"), 7, "nowhere/log.txt");
}

TEST_F(CommandLineTest, AFolderThatCannotBeMadeIsAMatterOfTheDiskHoweverDeep) {
    for (const char* folder : {"/proc/planlight", "/proc/none/x", "/proc/none/x/y"})
        expect_refused(run(std::string("patterns --width 64 --height 64 --out ") + folder), 7, "/proc/");
}

TEST_F(CommandLineTest, SettingsOfTheSiteAreReadAndSaid) {
    write_settings(
        R"({"format": "planlight config", "version": 1, "units": "cm", "surgeon_side": "head", "paper": "Letter",
                       "monitors": {"operator": "DP-1"}, "notes": "theatre 2"})");
    const auto with = run("board --verbose");
    EXPECT_EQ(with.exit_code, 0) << with.err;
    EXPECT_NE(with.err.find("config.json"), std::string::npos) << with.err;
}

TEST_F(CommandLineTest, SettingsThatAreNoneAreRefusedByName) {
    write_settings(R"({"format": "planlight config", "version": 1, "unit": "cm"})");
    expect_refused(run("board"), 3, "is \"units\" meant?");
    write_settings(R"({"format": "planlight config", "version": 1, "surgeon_side": "top"})");
    expect_refused(run("board"), 3, "\"feet\"");
    write_settings(R"({"format": "planlight config", "version": 1, "monitors": {"operater": "DP-1"}})");
    expect_refused(run("board"), 3, "operater");
    write_settings(R"({"format": "planlight config", "version": 1, "paper": "A5"})");
    expect_refused(run("board"), 3, "\"Letter\"");
    write_settings(R"({"format": "planlight config", "version": 1, "check_skin_every_min": 0.2})");
    expect_refused(run("board"), 3, "check_skin_every_min");
    write_settings("{");
    expect_refused(run("board"), 4, "config.json");
}

TEST_F(CommandLineTest, HelpNeedsNoSoundSettings) {
    write_settings("{");
    EXPECT_EQ(run("--help").exit_code, 0);
    EXPECT_EQ(run("register --help").exit_code, 0);
    EXPECT_EQ(run("--version").out, "planlight " PLANLIGHT_VERSION "\n");
}

}  // namespace
}  // namespace planlight::test
