#include <fmt/format.h>

#include <stdexcept>

#include "app/live/dark_at_the_end.h"
#include "tests/app/live/live_session_fixture.h"

namespace planlight {
namespace {

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

/// As a projector's process shows what a session hands over.
class CountsDarkness final : public Projector {
public:
    int width() const override { return 8; }
    int height() const override { return 8; }
    Instant show(const RgbImage&, Instant) override { return {}; }
    void go_dark() noexcept override { ++darks; }
    int darks = 0;
};

// The window is closed while the session's thread waits for a camera: the light must not wait with it.
TEST_F(LiveSessionTest, IsDarkAtItsEndBeforeItsThreadHasEnded) {
    followed();
    hold();
    CountsDarkness projector;
    { const DarkAtTheEnd dark(*session, &projector); }
    EXPECT_TRUE(waits.load()) << "the thread still waits";
    EXPECT_EQ(projector.darks, 1);
    EXPECT_EQ(bright_pixels(), -1);
    held = false;
    wait_for(*session, "the thread's end", [&](const OperatorModel&) {
        EXPECT_EQ(bright_pixels(), -1);
        return !session->projecting();
    });
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

TEST_F(LiveSessionTest, RegisterThatDarkOvertookCanBePressedAgain) {
    ready();
    session->post(OperatorAction::scan);
    wait_for(*session, "the scan", [](const OperatorModel& m) { return m.do_register.enabled; });
    hold();
    EXPECT_EQ(session->post(OperatorAction::do_register), "");
    session->post(OperatorAction::dark);
    const OperatorModel dark = session->model();
    held = false;
    EXPECT_EQ(dark.status.kind, StatusKind::dark);
    EXPECT_TRUE(dark.do_register.enabled) << "the scan is kept, and nobody looks for the patient";
    EXPECT_TRUE(dark.landmarks);
    EXPECT_EQ(session->not_kept().in_the_banner, "");
    EXPECT_EQ(session->post(OperatorAction::do_register), "");
    const OperatorModel found =
        wait_for(*session, "the match", [](const OperatorModel& m) { return m.track.enabled || m.confirm; });
    const NotKept not_kept = session->not_kept();
    EXPECT_EQ(not_kept.in_the_banner, "This match could not be kept: its folder cannot be written to.");
    EXPECT_EQ(not_kept.with_its_folder.find("This match could not be kept: /proc/planlight/matches: cannot be made: "),
              0U)
        << not_kept.with_its_folder;
    EXPECT_EQ(std::count(found.evidence.begin(), found.evidence.end(), not_kept.with_its_folder), 1) << "and goes on";
}

}  // namespace
}  // namespace planlight
