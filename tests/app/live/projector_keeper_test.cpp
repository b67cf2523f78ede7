// The projector of a session, with this program itself in place of the projector process: no window, every order noted.
#include "app/live/projector_keeper.h"

#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "planning_io/types/error.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

using namespace std::chrono_literals;

constexpr const char* kNotesAt = "PLANLIGHT_TEST_NOTES";

std::vector<std::string> own_arguments() {
    std::ifstream file("/proc/self/cmdline");
    std::vector<std::string> words;
    for (std::string word; std::getline(file, word, '\0');) words.push_back(word);
    return words;
}

/// Monitor number 1 is HDMI-2; a name is itself. Notes what would be lit, and what not.
[[noreturn]] void serve(const std::string& asked) {
    std::ofstream notes(std::getenv(kNotesAt), std::ios::app);
    notes << "opened " << asked << std::endl;
    LightMailbox mailbox(kProjectorMailbox);
    mailbox.say_alive(SteadyClock().now());
    mailbox.say_ready(8, 6, asked == "1" ? "HDMI-2" : asked);
    LightMailbox::Order order;
    for (char byte = 0;;) {
        mailbox.say_alive(SteadyClock().now());
        if (mailbox.take(order)) {
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
