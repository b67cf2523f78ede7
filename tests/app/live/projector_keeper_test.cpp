// The projector of a session, with this program itself in place of the projector process: no window, every order noted.
#include "app/live/projector_keeper.h"

#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/ptrace.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "planning_io/types/error.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

using namespace std::chrono_literals;

constexpr const char* kNotesAt = "PLANLIGHT_TEST_NOTES";
constexpr const char* kDrawsFor_ms = "PLANLIGHT_TEST_DRAWS_FOR_MS";  ///< each picture; none where it is not set

std::vector<std::string> own_arguments() {
    std::ifstream file("/proc/self/cmdline");
    std::vector<std::string> words;
    for (std::string word; std::getline(file, word, '\0');) words.push_back(word);
    return words;
}

/// Monitor number 1 is HDMI-2; a name is itself. Notes what would be lit, and what not.
[[noreturn]] void serve(const std::string& asked) {
    std::ofstream notes(std::getenv(kNotesAt), std::ios::app);
    notes << "process " << getpid() << std::endl << "opened " << asked << std::endl;
    LightMailbox mailbox(kProjectorMailbox);
    mailbox.say_alive(SteadyClock().now());
    mailbox.say_ready(8, 6, asked == "1" ? "HDMI-2" : asked);
    LightMailbox::Order order;
    for (char byte = 0;;) {
        mailbox.say_alive(SteadyClock().now());
        if (mailbox.take(order)) {
            if (const char* const draws = std::getenv(kDrawsFor_ms); draws && !order.picture.empty())
                std::this_thread::sleep_for(std::chrono::milliseconds(std::atoi(draws)));
            const bool lit = !order.picture.empty() && SteadyClock().now() < mailbox.lease_until();
            notes << (lit ? "lit" : "dark") << std::endl;
            mailbox.say_done(order.number, SteadyClock().now());
        }
        pollfd bell{kProjectorBell, POLLIN, 0};
        if (poll(&bell, 1, 5) > 0 && read(kProjectorBell, &byte, 1) <= 0) _exit(0);
    }
}

/// Before any test: this program was started as the projector process.
const bool kNoProjector = [] {
    const std::vector<std::string> words = own_arguments();
    if (words.size() == 4 && words[1] == "projector-window") serve(words[3]);
    return true;
}();

class ProjectorKeeperTest : public ::testing::Test {
protected:
    const test::TemporaryFolder folder_;
    ProjectorKeeperSettings settings_;

    void SetUp() override {
        ASSERT_TRUE(kNoProjector);
        setenv(kNotesAt, (folder_.path() / "notes").c_str(), 1);
        unsetenv(kDrawsFor_ms);
        settings_.retry_after = 1ms;
        settings_.window_patience = settings_.session_patience = 1h;
        settings_.process.silence_allowed = settings_.process.work_allowed = 1min;  // a busy machine is no fault here
    }
    std::vector<std::string> noted(const std::string& begin) const {
        std::ifstream file(folder_.path() / "notes");
        std::vector<std::string> lines;
        for (std::string line; std::getline(file, line);)
            if (line.starts_with(begin)) lines.push_back(line);
        return lines;
    }
    static Instant in_a_minute() { return SteadyClock().now() + 1min; }
};

// Once it is unplugged and plugged in again, the number may be that of the operator's screen.
TEST_F(ProjectorKeeperTest, AProjectorThatWasNamedByItsNumberComesBackOnItsOutput) {
    ProjectorKeeper projector("1", settings_);
    projector.disturb(SIGKILL);
    const Instant until = SteadyClock().now() + 20s;
    while (projector.starts() < 2 && SteadyClock().now() < until) std::this_thread::sleep_for(2ms);
    EXPECT_EQ(noted("opened"), (std::vector<std::string>{"opened 1", "opened HDMI-2"}));
}

// One that hangs in the graphics driver is killed and does not go; here another process holds it back. The operator's
// window is not held up by it, and is told that its light may be on; no second one is started beside it.
TEST_F(ProjectorKeeperTest, AProcessThatCannotBeEndedIsSaidAndWaitedForByNobody) {
    settings_.process.silence_allowed = 200ms;
    ProjectorKeeper projector("1", settings_);
    ASSERT_EQ(noted("process ").size(), 1u);
    const pid_t stuck = std::stoi(noted("process ").front().substr(8));
    int ready[2];
    ASSERT_EQ(pipe(ready), 0);
    const pid_t holder = fork();
    if (holder == 0) {
        const char held = ptrace(PTRACE_SEIZE, stuck, 0, 0) == 0 ? 'y' : 'n';
        static_cast<void>(!write(ready[1], &held, 1));
        pause();
        _exit(0);
    }
    char held = 'n';
    ASSERT_EQ(read(ready[0], &held, 1), 1);
    const auto let_go = [&] {
        kill(holder, SIGKILL);
        waitpid(holder, nullptr, 0);
    };
    if (held != 'y') {
        let_go();
        GTEST_SKIP() << "no process may be traced here";
    }
    projector.disturb(SIGSTOP);
    ProjectorProblem problem;
    Instant longest{};
    for (const Instant until = SteadyClock().now() + 10s; problem.empty() && SteadyClock().now() < until;) {
        const Instant before = SteadyClock().now();
        problem = projector.problem();
        longest = std::max(longest, SteadyClock().now() - before);
        std::this_thread::sleep_for(2ms);
    }
    EXPECT_EQ(problem.what, "Projector process: it cannot be ended, and its light may still be on");
    EXPECT_TRUE(problem.may_be_lit);
    projector.go_dark();  // DARK cannot reach it either, and must not make it "dark"
    EXPECT_LT(longest, 2s);
    std::this_thread::sleep_for(100ms);
    EXPECT_EQ(projector.starts(), 1);
    EXPECT_EQ(projector.problem().what, problem.what);
    projector.disturb(0);  // there is none: no process may be meant by that
    let_go();
    for (const Instant until = SteadyClock().now() + 20s; projector.starts() < 2 && SteadyClock().now() < until;)
        std::this_thread::sleep_for(2ms);
    EXPECT_EQ(projector.starts(), 2) << "it has gone, and another is started";
}

// Its lease has run out by then: nobody may be told that the picture is on the skin.
TEST_F(ProjectorKeeperTest, PromisesNoLightWhileTheOperatorsWindowDoesNotAnswer) {
    settings_.window_patience = 0ms;
    ProjectorKeeper projector("DUMMY1", settings_);
    try {
        projector.show(RgbImage(8, 6, {255, 255, 255}), in_a_minute());
        FAIL() << "it was lit";
    } catch (const DeviceError& error) {
        EXPECT_NE(std::string(error.what()).find("the operator's window does not answer"), std::string::npos);
    }
    EXPECT_TRUE(noted("lit").empty());
    EXPECT_FALSE(noted("dark").empty());
    EXPECT_TRUE(projector.problem().empty()) << "the projector is there: it is not looked for";
    EXPECT_EQ(projector.starts(), 1U);
}

// A match may take longer than the session's patience; what it lights after that must not be refused.
TEST_F(ProjectorKeeperTest, WhoShowsIsAlive) {
    settings_.session_patience = 0ms;
    settings_.process.lease = 1h;
    ProjectorKeeper projector("DUMMY1", settings_);
    EXPECT_NO_THROW(projector.show(RgbImage(8, 6, {255, 255, 255}), in_a_minute()));
    EXPECT_EQ(noted("lit").size(), 1U);
}

// A window's first picture, on a desktop that is just busy, takes longer than the lease; its light stays nevertheless.
TEST_F(ProjectorKeeperTest, APictureThatTakesLongerThanTheLeaseToDrawIsLit) {
    setenv(kDrawsFor_ms, "1500", 1);
    settings_.process.lease = 1s;
    ProjectorKeeper projector("DUMMY1", settings_);
    projector.show(RgbImage(8, 6, {255, 255, 255}), in_a_minute());
    EXPECT_EQ(noted("lit").size(), 1U);
}

// ... but where DARK was pressed meanwhile, the lease ends.
TEST_F(ProjectorKeeperTest, APictureThatTakesLongIsNotKeptLitAfterDark) {
    setenv(kDrawsFor_ms, "600", 1);
    settings_.process.lease = 200ms;
    ProjectorKeeper projector("DUMMY1", settings_);
    std::atomic<int> asked{0};
    projector.set_permission([&] { return ++asked == 1; });  // as it is handed over, and never again
    projector.show(RgbImage(8, 6, {255, 255, 255}), in_a_minute());
    EXPECT_TRUE(noted("lit").empty());
    EXPECT_GT(asked, 1);
}

// It had passed every check of its session before DARK was pressed, and was only then handed over.
TEST_F(ProjectorKeeperTest, APictureThatWasOnItsWayAtDarkIsNotLitAfterIt) {
    settings_.process.lease = 1h;
    ProjectorKeeper projector("DUMMY1", settings_);
    std::atomic<bool> permitted{true};
    projector.set_permission([&] { return permitted.load(); });
    projector.show(RgbImage(8, 6, {255, 255, 255}), in_a_minute());
    ASSERT_EQ(noted("lit").size(), 1U);
    permitted = false;
    projector.go_dark();
    EXPECT_NO_THROW(projector.show(RgbImage(8, 6, {255, 255, 255}), in_a_minute()));
    EXPECT_EQ(noted("lit").size(), 1U);
    EXPECT_EQ(noted("dark").size(), 2U);
    permitted = true;
    projector.show(RgbImage(8, 6, {255, 255, 255}), in_a_minute());
    EXPECT_EQ(noted("lit").size(), 2U);
}

TEST_F(ProjectorKeeperTest, AProjectorThatIsLostIsADeviceThatIsLost) {
    settings_.retry_after = 1h;
    ProjectorKeeper projector("DUMMY1", settings_);
    projector.disturb(SIGKILL);
    const auto shown = [&] {
        for (;;) projector.show(RgbImage(8, 6), in_a_minute());
    };
    EXPECT_THROW(shown(), DeviceError);
}

}  // namespace
}  // namespace planlight
