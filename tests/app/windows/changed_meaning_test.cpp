#include "app/windows/changed_meaning.h"

#include <gtest/gtest.h>

namespace planlight {
namespace {

using namespace std::chrono_literals;

OperatorModel model_of(OperatorAction next, const std::string& words = {}) {
    OperatorModel model;
    model.next = next;
    model.confirm_words = words;
    return model;
}

// The light is stopped, or somebody presses DARK, while the foot goes down.
TEST(ChangedMeaning, AKeyThatHasJustGotAnotherMeaningHasNone) {
    ChangedMeaning meaning;
    ChangedMeaning::Moment now{};
    meaning.look(model_of(OperatorAction::confirm, "Light 2 is right"), now);
    EXPECT_FALSE(meaning.just_changed(now += 5s));
    meaning.look(model_of(OperatorAction::scan), now);
    EXPECT_TRUE(meaning.just_changed(now + 200ms));
    EXPECT_FALSE(meaning.just_changed(now + 1s));
    meaning.look(model_of(OperatorAction::confirm, "Show landmarks"), now += 5s);
    meaning.look(model_of(OperatorAction::confirm, "Light 1 is right"), now += 5s);
    EXPECT_TRUE(meaning.just_changed(now + 200ms)) << "another thing to say yes to";
}

// What was waited for may be pressed at once; figures that change from look to look change no meaning.
TEST(ChangedMeaning, WhatLeadsOnAfterNothingDidMayBePressedAtOnce) {
    ChangedMeaning meaning;
    ChangedMeaning::Moment now{};
    meaning.look(model_of(OperatorAction::scan), now);
    meaning.look(model_of(OperatorAction::none), now += 1s);
    meaning.look(model_of(OperatorAction::do_register), now += 1s);
    EXPECT_FALSE(meaning.just_changed(now));
    OperatorModel model = model_of(OperatorAction::do_register, "words of no button");
    model.status.headline = "42 %";
    meaning.look(model, now += 1s);
    EXPECT_FALSE(meaning.just_changed(now));
}

}  // namespace
}  // namespace planlight
