// What the program presses by itself, and that darkness ends it.
#include "app/live/autoplay.h"

#include <gtest/gtest.h>

namespace planlight {
namespace {

/// Everything is free, and something is asked.
OperatorModel free_to_press(const std::string& words = "Light 1 is right") {
    OperatorModel model;
    for (auto* button : {&model.scan, &model.do_register, &model.track, &model.stop}) button->enabled = true;
    model.confirm = true;
    model.confirm_words = words;
    return model;
}

TEST(Autoplay, PressesTheButtonsInTheirOrderAndSaysYesOnlyInTheSimulatedRoom) {
    Autoplay simulated(true), real(false);
    for (const OperatorAction action : {OperatorAction::scan, OperatorAction::do_register, OperatorAction::track}) {
        EXPECT_EQ(simulated.next(free_to_press()), action);
        EXPECT_EQ(real.next(free_to_press()), action);
    }
    EXPECT_EQ(simulated.next(free_to_press()), OperatorAction::confirm);
    EXPECT_EQ(simulated.next(free_to_press()), OperatorAction::none) << "once";
    EXPECT_EQ(simulated.next(free_to_press("Light 2 is right")), OperatorAction::confirm);
    EXPECT_EQ(real.next(free_to_press()), OperatorAction::none);
}

// Whoever pressed DARK has a reason that the program does not know.
TEST(Autoplay, LightsNothingAfterAPersonMadeItDark) {
    for (const OperatorAction dark : {OperatorAction::dark, OperatorAction::stop}) {
        for (int before = 0; before < 4; ++before) {
            Autoplay autoplay(true);
            for (int i = 0; i < before; ++i) autoplay.next(free_to_press());
            autoplay.pressed(dark);
            autoplay.pressed(OperatorAction::none);
            EXPECT_EQ(autoplay.next(free_to_press("Light 2 is right")), OperatorAction::none) << before << " presses";
        }
    }
}

TEST(Autoplay, LightsNothingOnceTheProjectorWasAway) {
    Autoplay autoplay(true);
    autoplay.projector_lost();
    EXPECT_EQ(autoplay.next(free_to_press()), OperatorAction::none);
}

TEST(Autoplay, GoesOnBesideOtherPresses) {
    Autoplay autoplay(true);
    for (const OperatorAction action : {OperatorAction::none, OperatorAction::light_item, OperatorAction::confirm})
        autoplay.pressed(action);
    EXPECT_EQ(autoplay.next(free_to_press()), OperatorAction::scan);
}

}  // namespace
}  // namespace planlight
