// `planlight session` as a started program: heard by another system, ended with its report, and killed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <thread>

#include "app/recording/replay_session.h"
#include "app/recording/resume_offer.h"
#include "planning_io/case/case_folder.h"
#include "tests/app/igtl/igtl_receiver.h"
#include "tests/app/igtl/tcp_client.h"
#include "tests/app/run_command.h"
#include "tests/app/started_session.h"
#include "tests/support/test_data.h"

namespace planlight::test {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr auto kLongest = 240s;  // software OpenGL on a busy machine

class StartedSession : public ::testing::Test {
protected:
    void SetUp() override {
        if (!example_patient()) GTEST_SKIP() << "the package invesalius-examples is not installed";
        display_ = BlindDisplay::start();
        if (!display_) GTEST_SKIP() << "the package xvfb is not installed, or it does not start";
        const CommandRun made =
            run_planlight("prepare '" + example_patient()->string() +
                              "' --plan '" PLANLIGHT_EXAMPLE_FOLDER "/frontal_defect.mrk.json' --out case",
                          folder_.path());
        ASSERT_EQ(made.exit_code, 0) << made.err;
    }
    std::unique_ptr<StartedProgram> start(const std::vector<std::string>& more) {
        std::vector<std::string> words{"session", case_, "--volume", example_patient()->string(), "--autoplay"};
        words.insert(words.end(), more.begin(), more.end());
        return std::make_unique<StartedProgram>(*display_, words, folder_.path());
    }
    /// The only one of the case.
    fs::path recording() const {
        fs::path found;
        for (const auto& entry : fs::directory_iterator(fs::path(case_) / "recordings"))
            if (entry.path().extension() == ".plrec") found = entry.path();
        return found;
    }
    bool there(const fs::path& beside) const { return fs::exists(beside) && fs::file_size(beside) > 1000; }

    TemporaryFolder folder_;
    const std::string case_ = (folder_.path() / "case").string();
    std::unique_ptr<BlindDisplay> display_;
};

/// A port that nobody listens on.
int port_for_igtl() {
    constexpr int kFirst = 20000, kPorts = 20000;
    int port = kFirst + static_cast<int>(::getpid()) % kPorts;
    while (TcpClient(port).connected()) ++port;
    return port;
}

bool comes_to_listen(int port) {
    for (const auto until = std::chrono::steady_clock::now() + kLongest; std::chrono::steady_clock::now() < until;) {
        if (TcpClient(port).connected()) return true;
        std::this_thread::sleep_for(50ms);
    }
    return false;
}

TEST_F(StartedSession, IsHeardByAnotherSystemAndEndsWithItsReport) {
    const int port = port_for_igtl();
    const fs::path shots = folder_.path() / "shots";
    const auto program = start({"--igtl", std::to_string(port), "--end-after-s", "6", "--operator-name",
                                "Dr. Anna Meier", "--screenshots", shots.string()});
    ASSERT_TRUE(comes_to_listen(port)) << program->said();
    IgtlReceiver receiver(port);
    EXPECT_EQ(program->wait(kLongest), 0) << program->said();
    const auto& all = receiver.all();
    const auto heard = [&](const char* type, const char* device) {
        return std::any_of(all.begin(), all.end(),
                           [&](const ReceivedMessage& m) { return m.type == type && m.device == device && m.sound; });
    };
    EXPECT_TRUE(heard("STATUS", "Gate"));
    for (const char* device : {"T_ini", "T_cur", "T_global"}) EXPECT_TRUE(heard("TRANSFORM", device)) << device;
    EXPECT_TRUE(heard("POLYDATA", "Skin"));
    ASSERT_FALSE(all.empty());
    EXPECT_EQ(all.back().word, "ended");

    const fs::path file = recording();
    EXPECT_NE(program->said().find("The report of this session: "), std::string::npos) << program->said();
    for (const char* extension : {".html", ".json", ".pdf"}) {
        const fs::path beside = fs::path(file).replace_extension(extension);
        ASSERT_TRUE(there(beside)) << beside;
        EXPECT_EQ(fs::status(beside).permissions(), fs::perms::owner_read | fs::perms::owner_write);
    }
    EXPECT_EQ(whole(fs::path(file).replace_extension(".pdf")).substr(0, 5), "%PDF-");
    const RecordingHead head = head_of_recording(file);
    EXPECT_EQ(head.operator_name, "Dr. Anna Meier");
    EXPECT_TRUE(head.operator_named);
    EXPECT_NE(head.settings.find("\"simulated\":"), std::string::npos) << head.settings;
    EXPECT_EQ(head.settings.find("light_delay"), std::string::npos) << "a simulated projector has none to be told";
    int lights = 0;
    for (const auto& picture : fs::directory_iterator(shots)) {
        lights += picture.path().filename().string().starts_with("light-");
        EXPECT_EQ(picture.status().permissions(), fs::perms::owner_read | fs::perms::owner_write)
            << picture.path() << ": a face, or the card with a name";
    }
    EXPECT_GT(lights, 0);
}

/// Bytes in small letters, and again as texts of two bytes a letter have them.
bool holds(const fs::path& file, const std::string& small) {
    std::string bytes = whole(file), wide;
    std::transform(bytes.begin(), bytes.end(), bytes.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    for (const char c : small) wide += c, wide += '\0';
    return bytes.find(small) != std::string::npos || bytes.find(wide) != std::string::npos;
}

/// Patient, plan, operator and folders are called so; whoever reads the recording, or the report beside it, meets
/// nobody.
TEST_F(StartedSession, ThatIsAnonymousHoldsNoNameOfAnybody) {
    const fs::path home = folder_.path() / "KRANICHFELD^XAVERIA";
    fs::create_directory(home);
    const CommandRun made = run_planlight(
        "prepare '" + example_patient()->string() +
            "' --plan '" PLANLIGHT_EXAMPLE_FOLDER
            "/frontal_defect.mrk.json' --out case --patient 'KRANICHFELD, Xaveria' "
            "--title \"Kranichfeld's forehead\" --plan-name 'Kranichfeld by Xaveria' --plan-version 'Xaveria 2'",
        home);
    ASSERT_EQ(made.exit_code, 0) << made.err;
    const fs::path records = home / "Xaveria's recordings";
    StartedProgram program(*display_,
                           {"session", (home / "case").string(), "--volume", example_patient()->string(), "--autoplay",
                            "--anonymous", "--operator-name", "Prof. Xaveria Kranichfeld", "--recordings",
                            records.string(), "--screenshots", (home / "shots").string(), "--end-after-s", "3"},
                           folder_.path());
    EXPECT_EQ(program.wait(kLongest), 0) << program.said();
    int files = 0;
    for (const auto& entry : fs::directory_iterator(records)) {
        ++files;
        EXPECT_EQ(entry.status().permissions(), fs::perms::owner_read | fs::perms::owner_write);
        for (const char* name : {"kranichfeld", "xaveria"}) EXPECT_FALSE(holds(entry.path(), name)) << entry << name;
    }
    EXPECT_EQ(files, 4) << "the recording, and its report as page, figures and PDF";
    EXPECT_EQ(fs::status(records).permissions(), fs::perms(0700));
    EXPECT_TRUE(holds(home / "case" / "case.json", "kranichfeld")) << "else there was nothing to be left out";
}

TEST_F(StartedSession, ThatIsKilledLeavesARecordingToGoOnWithAndNoReport) {
    const auto program = start({});
    const auto last = [&]() -> std::optional<LastSession> { return last_session(fs::path(case_) / "recordings"); };
    for (const auto until = std::chrono::steady_clock::now() + kLongest; std::chrono::steady_clock::now() < until;) {
        const auto now = last();
        if ((now && now->last.match) || program->wait(0s) >= 0) break;
        std::this_thread::sleep_for(200ms);
    }
    std::this_thread::sleep_for(500ms);  // into the following
    program->kill();
    EXPECT_EQ(program->wait(10s), 128 + 9) << program->said();
    const auto now = last();
    ASSERT_TRUE(now);
    EXPECT_TRUE(now->last.match) << now->last.why_none;
    for (const char* extension : {".html", ".json", ".pdf"})
        EXPECT_FALSE(fs::exists(fs::path(now->recording).replace_extension(extension)));
}

TEST_F(StartedSession, WithoutAReportHasNoneAndIsReplayedAndReviewedInAWindow) {
    const auto program = start({"--no-report", "--end-after-s", "1", "--record", "all", "--language", "ru"});
    EXPECT_EQ(program->wait(kLongest), 0) << program->said();
    EXPECT_FALSE(fs::exists(fs::path(recording()).replace_extension(".html")));
    EXPECT_EQ(program->said().find("The report of this session"), std::string::npos) << program->said();
    const fs::path shots = folder_.path() / "shots";
    StartedProgram replay(
        *display_,
        {"replay", recording().string(), "--show", "--close", "--speed", "10", "--screenshots", shots.string()},
        folder_.path());
    EXPECT_EQ(replay.wait(kLongest), 0) << replay.said();
    EXPECT_NE(replay.said().find("Alike to the last digit: 1 scan, 1 match"), std::string::npos) << replay.said();
    ASSERT_TRUE(fs::exists(shots));
    EXPECT_FALSE(fs::is_empty(shots));
    const fs::path window = folder_.path() / "review.png";
    StartedProgram review(*display_,
                          {"review", recording().string(), "--show", "--at", "1e6", "--picture", window.string()},
                          folder_.path());
    EXPECT_EQ(review.wait(kLongest), 0) << review.said();
    EXPECT_TRUE(there(window)) << review.said();
}

}  // namespace
}  // namespace planlight::test
