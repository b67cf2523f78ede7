// A session that checks the skin by itself: markers that slid all together are found though nobody presses anything.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>

#include "app/live/live_session.h"
#include "tests/app/slipping_room.h"

namespace planlight {
namespace {

using namespace std::chrono_literals;
using test::wait_for;

class SkinCheckedByItself : public ::testing::Test {
protected:
    void SetUp() override {
        if (!test::example_case().there) GTEST_SKIP() << "the package invesalius-examples is not installed";
    }
    /// Counts the checks of the skin, and the presses of persons.
    class Checks final : public SessionObserver {
    public:
        void skin_checked(const SkinCheck& check) noexcept override {
            known += check.known;
            ++all;
        }
        void pressed(const std::string& action) noexcept override { pressed_checks += action == "check skin"; }
        std::atomic<int> all{0}, known{0}, pressed_checks{0};
    };
    /// Follows a head at rest, verified, until `holds`.
    template <class Holds>
    static OperatorModel follow(bool markers_slip, Checks& checks, Holds holds) {
        simulation::RoomSettings room;
        room.preset = simulation::Preset::paper;
        const Case& the_case = test::example_case().prepared;
        const CaseDrawing drawing(the_case);
        SkinCheckScheduleSettings soon;
        soon.every = 1500ms;
        soon.announced_for = 500ms;
        soon.still_for = 300ms;
        LiveSession session(
            [&](const RoomProgress&) { return std::make_unique<test::SlippingRoom>(room, markers_slip); }, the_case,
            drawing, {}, &checks, {}, soon);
        test::begin_to_follow(session);
        test::LandmarkWitness witness(session);
        return wait_for(session, "what is expected", [&](const OperatorModel& m) {
            witness.look(m);
            return holds(m);
        });
    }
};

TEST_F(SkinCheckedByItself, LightOnSkinThatLiesWhereItLayComesBackGreen) {
    Checks checks;
    std::atomic<bool> announced{false};
    const OperatorModel green = follow(false, checks, [&](const OperatorModel& m) {
        for (const std::string& detail : m.status.details)
            if (detail.find("keep the patient still") != std::string::npos) announced = true;
        return checks.known >= 2 && m.status.kind == StatusKind::aligned;
    });
    EXPECT_TRUE(announced.load());
    EXPECT_EQ(checks.pressed_checks, 0) << "nobody did";
    EXPECT_EQ(
        std::ranges::count_if(green.evidence, [](const std::string& words) { return words.find("Skin checked") == 0; }),
        1)
        << "of many checks the last stands there";
}

TEST_F(SkinCheckedByItself, MarkersThatSlidAllTogetherEndTheLight) {
    Checks checks;
    const OperatorModel refused =
        follow("markers", checks, [&](const OperatorModel& m) { return m.status.kind == StatusKind::refused; });
    EXPECT_GE(checks.all, 1);
    EXPECT_NE(refused.status.headline.find("where the markers put it"), std::string::npos) << refused.status.headline;
}

}  // namespace
}  // namespace planlight
