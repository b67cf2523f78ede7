#include "app/live/live_session.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <thread>

#include "app/live/simulated_room.h"
#include "tests/app/played_session.h"

namespace planlight {
namespace {

using namespace std::chrono_literals;

/// Waits as long as it takes on a busy machine; nothing here is a question of time.
template <typename Holds>
OperatorModel wait_for(LiveSession& session, const char* what, const Holds& holds) {
    const auto until = std::chrono::steady_clock::now() + 300s;
    for (;;) {
        const OperatorModel model = session.model();
        if (holds(model)) return model;
        session.rethrow_fault();
        if (std::chrono::steady_clock::now() > until)
            throw std::runtime_error(std::string("waited in vain for ") + what + ": " + model.status.headline);
        std::this_thread::sleep_for(5ms);
    }
}

/// A session in the simulated room, from its first moment.
class LiveSessionTest : public testing::Test {
protected:
    void SetUp() override {
        if (!test::example_case().there) GTEST_SKIP() << "invesalius-examples is not installed";
        room.preset = simulation::Preset::paper;
        session = std::make_unique<LiveSession>(
            [this](const RoomProgress& progress) {
                progress("The room of a test.", 0.25);
                return std::make_unique<SimulatedRoom>(test::example_case().volume, test::example_case().prepared.plan,
                                                       room, 5);
            },
            test::example_case().prepared, drawing(), std::filesystem::path{});
    }
    static const CaseDrawing& drawing() {
        static const CaseDrawing made(test::example_case().prepared);
        return made;
    }
    OperatorModel ready() {
        return wait_for(*session, "ready", [](const OperatorModel& m) { return m.scan.enabled; });
    }
    OperatorModel followed() {
        ready();
        session->post(OperatorAction::scan);
        wait_for(*session, "the scan", [](const OperatorModel& m) { return m.do_register.enabled; });
        session->post(OperatorAction::do_register);
        const OperatorModel matched =
            wait_for(*session, "the match", [](const OperatorModel& m) { return m.track.enabled || m.confirm; });
        if (matched.confirm) session->post(OperatorAction::confirm);
        wait_for(*session, "Track", [](const OperatorModel& m) { return m.track.enabled; });
        session->post(OperatorAction::track);
        return wait_for(*session, "light",
                        [](const OperatorModel& m) { return m.figures.delay_to_light_ms.has_value(); });
    }

    simulation::RoomSettings room;
    std::unique_ptr<LiveSession> session;
};

TEST_F(LiveSessionTest, SaysFirstWhatIsBeingMadeAndThenShowsLivePicturesWithTheirMarkers) {
    const OperatorModel first = session->model();
    if (!first.scan.enabled) {
        EXPECT_EQ(first.status.kind, StatusKind::waiting);
        EXPECT_FALSE(first.status.headline.empty());
    }
    EXPECT_EQ(ready().status.kind, StatusKind::ready);
    const OperatorModel live = wait_for(
        *session, "pictures", [](const OperatorModel& m) { return m.left.live.searched && m.left.live.picture; });
    EXPECT_GE(live.left.live.found.size(), 5U) << "before anything was scanned";
    EXPECT_GE(live.right.live.found.size(), 5U);
}

TEST_F(LiveSessionTest, APressThatIsNotPossibleIsAnsweredAndDoesNothing) {
    EXPECT_NE(session->post(OperatorAction::track), "");
    ready();
    EXPECT_EQ(session->post(OperatorAction::track), "Track is not possible now: register first.");
    EXPECT_EQ(session->post(OperatorAction::do_register), "Register is not possible now: scan first.");
    EXPECT_EQ(session->post(OperatorAction::scan), "");
    EXPECT_NE(session->post(OperatorAction::scan), "") << "a second press does not begin a second scan";
    EXPECT_EQ(session->model().status.kind, StatusKind::scanning) << "said at once";
}

TEST_F(LiveSessionTest, AScanThatIsEndedByDarkLeavesButtonsAndWordsRight) {
    followed();
    EXPECT_TRUE(session->model().light_on);
    session->post(OperatorAction::scan);
    const OperatorModel scanning = session->model();
    EXPECT_EQ(scanning.figures, Figures{}) << "those of the light before";
    EXPECT_FALSE(scanning.fit);
    EXPECT_FALSE(scanning.rows.front().predicted_error_mm);
    while (session->model().status.share < 0.1) {
        const OperatorModel during = session->model();
        EXPECT_EQ(during.status.kind, StatusKind::scanning) << "the last update of the light says nothing any more";
        EXPECT_EQ(during.figures, Figures{});
        EXPECT_EQ(during.scene.light, nullptr);
        std::this_thread::sleep_for(1ms);
    }
    session->post(OperatorAction::dark);
    for (const OperatorModel& dark :
         {session->model(), (std::this_thread::sleep_for(2s), session->model())}) {  // at once, and when it has ended
        EXPECT_EQ(dark.status.kind, StatusKind::dark);
        EXPECT_TRUE(dark.scan.enabled);
        EXPECT_FALSE(dark.do_register.enabled) << "there is no scan any more";
        EXPECT_FALSE(dark.track.enabled);
        EXPECT_FALSE(dark.landmarks);
        EXPECT_EQ(dark.next, OperatorAction::scan);
    }
    EXPECT_EQ(session->post(OperatorAction::scan), "") << "and it can be begun again";
    wait_for(*session, "the scan", [](const OperatorModel& m) { return m.do_register.enabled; });
}

TEST_F(LiveSessionTest, LightIsConfirmedOncePerPressAndDarkLeadsBackToTheMatch) {
    followed();
    wait_for(*session, "the question", [](const OperatorModel& m) { return m.confirm; });
    EXPECT_EQ(session->post(OperatorAction::confirm), "");
    EXPECT_NE(session->post(OperatorAction::confirm), "") << "the next landmark has not been lit yet";
    const OperatorModel first =
        wait_for(*session, "the first landmark", [](const OperatorModel& m) { return m.confirm; });
    EXPECT_EQ(first.confirm_words, "Light 1 is right");
    EXPECT_EQ(first.next, OperatorAction::confirm);
    for (const std::string& detail : first.status.details)
        EXPECT_EQ(detail.find("Show landmarks"), std::string::npos) << "there is no such button any more: " << detail;
    session->post(OperatorAction::dark);
    const OperatorModel dark = session->model();
    EXPECT_EQ(dark.status.kind, StatusKind::dark);
    EXPECT_EQ(dark.figures, Figures{});
    EXPECT_FALSE(dark.confirm);
    EXPECT_FALSE(dark.light_on);
    EXPECT_TRUE(dark.track.enabled) << "the match is kept";
    EXPECT_TRUE(dark.fit);
}

}  // namespace
}  // namespace planlight
