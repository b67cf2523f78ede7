// What the window of a replay says of light that went out, and of what was lit.
#include "app/live/replay_view.h"

#include <gtest/gtest.h>

#include <functional>

#include "app/recording/replay_session.h"
#include "planning_io/types/error.h"
#include "tests/app/played_session.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

constexpr Instant kNow = std::chrono::seconds(100);

/// The calls of a session that follows the patient, told by hand.
class ReplayViewTest : public ::testing::Test {
protected:
    void SetUp() override {
        if (!test::example_case().there) GTEST_SKIP() << "the package invesalius-examples is not installed";
        view_ = std::make_unique<ReplayView>(test::example_case().prepared, drawing());
        view_->asked(SessionCall::update, {}, -1);
        LightGate::Ruling good;
        good.trust = LightTrust::aligned;
        good.headline = "The plan is on the skin.";
        view_->gate(GateCall::step, kNow, 0, &good);
        ASSERT_EQ(status().kind, StatusKind::aligned);
    }
    static const CaseDrawing& drawing() {
        static const CaseDrawing made(test::example_case().prepared);
        return made;
    }
    Status status() const { return view_->model().status; }
    void go_dark() { view_->asked(SessionCall::go_dark, {}, -1); }
    void expect_stopped(GateCall call) {
        LightGate::Ruling stop;
        stop.headline = "Dark: the light lay 3.1 mm beside the plan.";
        stop.stop = true;
        view_->gate(call, kNow, 0, &stop);
        go_dark();
        EXPECT_EQ(status().kind, StatusKind::refused);
        EXPECT_EQ(status().headline, stop.headline);
    }
    std::unique_ptr<ReplayView> view_;
};

TEST_F(ReplayViewTest, LightThatTheGateStoppedStaysRefusedOnceItIsDark) {
    expect_stopped(GateCall::step);
}

TEST_F(ReplayViewTest, LightThatTheGateForbidsIsRefused) {
    expect_stopped(GateCall::forbids);
}

TEST_F(ReplayViewTest, ALostDeviceIsDarkAndTheLightComesBackByItself) {
    view_->refused(SessionCall::update, DeviceError("Left camera", "no frame came in 250 ms", "Look at its cable."));
    go_dark();
    view_->asked(SessionCall::update, {}, -1);  // it is tried again at once
    EXPECT_EQ(status().kind, StatusKind::dark);
    EXPECT_EQ(status().headline, "Dark: Left camera: no frame came in 250 ms.");
    EXPECT_EQ(view_->model().steps[4], StepState::attention) << "it is still followed";
}

TEST_F(ReplayViewTest, DarkThatWasPressedIsDarkAndNotReady) {
    go_dark();
    EXPECT_EQ(status().kind, StatusKind::dark);
    view_->asked(SessionCall::scan, {}, -1);
    EXPECT_EQ(status().kind, StatusKind::scanning);
    const CheckFailedError ended("The scan was ended by DARK", "Press Scan to begin again.");
    view_->stopped(ended);
    view_->refused(SessionCall::scan, ended);
    go_dark();
    EXPECT_EQ(status().kind, StatusKind::dark);
    EXPECT_EQ(status().headline, "Dark: no light on the patient.");
}

/// Looks at the view after each update, beside what the replayed session itself has.
class Beside final : public SessionObserver {
public:
    explicit Beside(ReplayView& view) : view_(view) {}
    void room_entered(const RoomFacts& room) noexcept override { view_.room_entered(room); }
    void asked(SessionCall call, const std::vector<PointPair>& landmarks, int which) noexcept override {
        view_.asked(call, landmarks, which);
        if (call == SessionCall::light_landmark) landmark_ = which >= 0;
    }
    void scanned(const Session& session) noexcept override { view_.scanned(session); }
    void matched(const Session& session) noexcept override { view_.matched(session); }
    void updated(const Session& session, const Session::Update& update) noexcept override {
        view_.updated(session, update);
        const OperatorModel m = view_.model();
        if (landmark_) return;
        const auto bright = session.item_of_moment();
        wrong += m.scene.bright_item != (bright ? static_cast<int>(*bright) : -1) || m.item_of_moment != bright;
        alone += bright.has_value();
        hidden += !session.hidden_items().empty();
        for (const Stroke& stroke : m.scene.plan->strokes)
            wrong += session.hidden_items().contains(static_cast<std::size_t>(std::max(0, stroke.item)));
    }
    void gate(GateCall call, Instant at, double off_mm, const LightGate::Ruling* ruling) noexcept override {
        view_.gate(call, at, off_mm, ruling);
    }
    int wrong = 0, alone = 0, hidden = 0;

private:
    ReplayView& view_;
    bool landmark_ = false;
};

// One item hidden, another alone bright, and then, by one press, the whole plan.
TEST_F(ReplayViewTest, WhatIsBrightAndWhatIsHiddenIsThatOfTheSession) {
    const test::TemporaryFolder folder;
    const auto file = folder.path() / "session.plrec";
    test::PlayedSession how;
    how.seed = 5;
    how.hide_items = true;
    how.updates = 60;
    test::record_session(how, test::example_case(), RecordMode::all, file);
    ReplayView view(test::example_case().prepared, drawing(), {1e6, 1});
    Beside beside(view);
    EXPECT_FALSE(replay_session(file, test::example_case().prepared, {}, &beside).difference);
    EXPECT_GE(beside.alone, 5);
    EXPECT_GE(beside.hidden, 5);
    EXPECT_EQ(beside.wrong, 0);
    EXPECT_FALSE(view.model().item_of_moment);
}

}  // namespace
}  // namespace planlight
