#include "app/live/silent_session.h"

#include <gtest/gtest.h>

#include "app/live/session_states.h"
#include "tests/app/windows/fake_model.h"

namespace planlight {
namespace {

using namespace std::chrono_literals;

OperatorModel green() {
    OperatorModel model = test::fake_model();
    model.status = {StatusKind::aligned, "The plan is on the skin.", {}, {}};
    model.scene.light = std::make_shared<std::vector<LightLine>>();
    model.figures.overlay_error_mm = 0.3;
    return model;
}

// The light has expired by then; its last words would say that the plan is on the skin.
TEST(SilentSession, GreenDoesNotOutliveTheSessionThatSaidIt) {
    OperatorModel model = green();
    say_silence(model, true, 501ms, 500ms);
    EXPECT_EQ(model.status.kind, StatusKind::dark);
    EXPECT_EQ(model.status.headline, "Dark: the session does not answer.");
    EXPECT_EQ(model.figures, Figures{});
    EXPECT_EQ(model.scene.light, nullptr);
    EXPECT_FALSE(model.confirm) << "of light that is not there nobody can say that it is right";
    for (const PlanRow& row : model.rows) EXPECT_FALSE(row.light_off_mm) << row.name;
}

TEST(SilentSession, AQuestionAboutTheLightGoesToo) {
    OperatorModel model = green();
    model.status.kind = StatusKind::check;
    model.confirm = true;
    model.next = OperatorAction::confirm;
    say_silence(model, true, 1s, 500ms);
    EXPECT_EQ(model.status.kind, StatusKind::dark);
    EXPECT_FALSE(model.confirm);
    EXPECT_EQ(model.next, OperatorAction::none);
}

TEST(SilentSession, ASessionThatAnswersSpeaksForItself) {
    const OperatorModel before = green();
    OperatorModel model = before;
    say_silence(model, true, 500ms, 500ms);
    EXPECT_EQ(model, before);
}

// While a match is computed nothing is lit, and while stripes are on the skin they are said to be.
TEST(SilentSession, WhatComputesWithoutLightIsLeftAlone) {
    OperatorModel model = green();
    say_silence(model, false, 10s, 500ms);
    EXPECT_EQ(model.status.kind, StatusKind::aligned);
    OperatorModel checking;
    enter(SessionState::checking_skin, {}, checking);
    say_silence(checking, true, 10s, 500ms);
    EXPECT_EQ(checking.status.kind, StatusKind::scanning);
}

}  // namespace
}  // namespace planlight
