#include "planning_io/plan/plan_file.h"
#include "tests/app/live/live_session_fixture.h"
#include "tests/app/slipping_room.h"

namespace planlight {
namespace {

TEST_F(LiveSessionTest, LightIsConfirmedOncePerPressAndDarkLeadsBackToTheMatch) {
    followed();
    wait_for(*session, "the question", [](const OperatorModel& m) { return m.confirm; });
    hold();
    EXPECT_EQ(session->post(OperatorAction::confirm), "");
    EXPECT_NE(session->post(OperatorAction::confirm), "") << "the next landmark has not been lit yet";
    held = false;
    const OperatorModel first =
        wait_for(*session, "the first landmark", [](const OperatorModel& m) { return m.confirm; });
    EXPECT_GE(counts.since, 12) << "half a second at 25 frames/s: a press that bounces has looked at nothing";
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

// The others are dim on the skin, and the light of the one that is bright is what is measured.
TEST_F(LiveSessionTest, OneItemOfThePlanAloneIsBrightAndThenTheWholePlanAgain) {
    EXPECT_NE(session->post_item(OperatorAction::light_item, 0), "") << "there is no match yet";
    const OperatorModel plan = followed();
    ASSERT_TRUE(plan.may_light_item);
    ASSERT_GT(plan.rows.size(), 2U);
    const auto lit = [&](const char* what, const auto& holds) {
        wait_for(*session, what, [&](const OperatorModel& m) { return holds(m) && bright_pixels() > 0; });
        return bright_pixels();
    };
    const long whole = lit("the plan", [](const OperatorModel& m) { return !m.item_of_moment; });
    EXPECT_EQ(session->post_item(OperatorAction::light_item, 1), "");
    const auto told = [](const OperatorModel& m) {
        return std::any_of(m.status.details.begin(), m.status.details.end(),
                           [](const std::string& detail) { return detail.find("\" is bright") != std::string::npos; });
    };
    const long alone = lit("one item", [&](const OperatorModel& m) { return m.item_of_moment == 1U && told(m); });
    EXPECT_LT(alone, whole / 2);
    EXPECT_EQ(session->model().scene.bright_item, 1);
    EXPECT_EQ(session->post_item(OperatorAction::light_item, std::nullopt), "");
    const long again = lit("the plan", [&](const OperatorModel& m) { return !m.item_of_moment && !told(m); });
    EXPECT_GT(again, 0.8 * static_cast<double>(whole));
    session->post(OperatorAction::scan);
    EXPECT_FALSE(session->model().item_of_moment);
}

// From the first picture of the window to the first light that is verified, by the one key that leads on (Enter, or a
// pedal): nothing is typed, nothing chosen.
TEST_F(LiveSessionTest, TheKeyThatLeadsOnComesToVerifiedLightInSixPresses) {
    int presses = 0;
    std::string last;
    for (;;) {
        const OperatorModel model = wait_for(*session, "what leads on", [&](const OperatorModel& m) {
            const bool same = m.next == OperatorAction::confirm && m.confirm_words == last;
            return m.status.kind == StatusKind::aligned || (m.next != OperatorAction::none && !same);
        });
        if (model.status.kind == StatusKind::aligned) break;
        last = model.confirm_words;
        ASSERT_EQ(session->post(model.next), "") << "what leads on is possible";
        ASSERT_LE(++presses, 12);
    }
    EXPECT_EQ(presses, 6) << "Scan, Register, Track, Show landmarks, Light 1 is right, Light 2 is right";
}

// CHECK measures the plan beside it as ever: the gate comes to its question, and the words ask to read the card.
TEST_F(LiveSessionTest, TheCardWithThePatientsNameIsLitUntilALandmarkHasBeen) {
    followed();
    const auto asks = [](const OperatorModel& m) { return says(m, "Read the card on the skin"); };
    const OperatorModel first = wait_for(*session, "the question",
                                         [&](const OperatorModel& m) { return says(m, "two landmarks") && m.confirm; });
    EXPECT_TRUE(asks(first)) << first.status.details.back();
    for (const PlanRow& row : first.rows) EXPECT_LT(row.light_off_mm.value_or(0), 1);
    const long with_card = bright_pixels();
    for (int yes = 0; yes < 3; ++yes) {
        wait_for(*session, "the question", [](const OperatorModel& m) { return m.confirm; });
        session->post(OperatorAction::confirm);
    }
    const OperatorModel after =
        wait_for(*session, "ALIGNED", [](const OperatorModel& m) { return m.status.kind == StatusKind::aligned; });
    EXPECT_FALSE(asks(after));
    EXPECT_LT(bright_pixels(), with_card);
}

// What a person hid is not lit, and not missed: the light of the rest is judged, and the words say that it is a part.
TEST_F(LiveSessionTest, AHiddenItemIsNeitherLitNorMissedAndAllHiddenIsDarkAndSaysSo) {
    EXPECT_NE(session->post_item(OperatorAction::hide_item, 0), "") << "there is no match yet";
    const std::size_t count = followed().rows.size();
    ASSERT_GT(count, 2U);
    const auto lit = [&](const char* what, const auto& holds) {
        return wait_for(*session, what, [&](const OperatorModel& m) { return holds(m) && bright_pixels() > 0; });
    };
    lit("the plan", [](const OperatorModel& m) { return m.rows[0].light_off_mm && m.rows[1].light_off_mm; });
    const long whole = bright_pixels();
    EXPECT_EQ(session->post_item(OperatorAction::hide_item, 0), "");
    EXPECT_EQ(session->post_item(OperatorAction::hide_item, 1), "");
    const OperatorModel rest = lit("the rest", [](const OperatorModel& m) {
        return m.rows[1].hidden && m.rows[2].light_off_mm && says(m, "2 of ") && says(m, "two landmarks");
    });
    EXPECT_LT(bright_pixels(), 0.9 * static_cast<double>(whole));
    EXPECT_TRUE(rest.rows[0].hidden);
    EXPECT_FALSE(rest.rows[0].light_off_mm) << "nobody looks for light that is not there";
    EXPECT_FALSE(says(rest, "is not measured")) << "the gate asks for what is shown alone";
    for (const Stroke& stroke : rest.scene.plan->strokes) EXPECT_GT(stroke.item, 1) << "nor is it in the 3-D view";
    // Landmarks are lit as ever, and the light of the part is trusted as a part.
    for (int yes = 0; yes < 3; ++yes) {
        wait_for(*session, "the question", [](const OperatorModel& m) { return m.confirm; });
        session->post(OperatorAction::confirm);
    }
    const OperatorModel aligned =
        wait_for(*session, "ALIGNED", [](const OperatorModel& m) { return m.status.kind == StatusKind::aligned; });
    EXPECT_EQ(aligned.status.headline, "What is shown of the plan is on the skin.");
    EXPECT_TRUE(says(aligned, fmt::format("2 of {} items are hidden", count)));
    for (std::size_t i = 2; i < count; ++i) EXPECT_EQ(session->post_item(OperatorAction::hide_item, i), "");
    const OperatorModel none = wait_for(*session, "darkness", [](const OperatorModel& m) {
        return m.status.headline == "Dark: every item of the plan is hidden.";
    });
    EXPECT_EQ(none.status.kind, StatusKind::dark);
    EXPECT_EQ(bright_pixels(), -1);
    // One item alone is shown by that; then the whole plan, by one press.
    EXPECT_EQ(session->post_item(OperatorAction::light_item, 1), "");
    lit("an item that was hidden", [](const OperatorModel& m) { return m.item_of_moment == 1U && !m.rows[1].hidden; });
    EXPECT_EQ(session->post_item(OperatorAction::show_item, std::nullopt), "");
    const OperatorModel again = lit("the plan", [](const OperatorModel& m) {
        return !m.item_of_moment && m.rows[0].light_off_mm && m.status.kind == StatusKind::aligned;
    });
    EXPECT_EQ(again.status.headline, "The plan is on the skin.");
    for (const PlanRow& row : again.rows) EXPECT_FALSE(row.hidden);
}

// It was taken, and asks for no light: DARK gives up what does, and nothing else.
TEST_F(LiveSessionTest, AnItemThatWasHiddenRightBeforeDarkIsNotLitAfterwards) {
    followed();
    hold();
    EXPECT_EQ(session->post_item(OperatorAction::hide_item, 0), "");
    session->post(OperatorAction::dark);
    held = false;
    wait_for(*session, "Track", [](const OperatorModel& m) { return m.track.enabled && m.rows[0].hidden; });
    session->post(OperatorAction::track);
    const OperatorModel lit = wait_for(
        *session, "light", [&](const OperatorModel& m) { return m.rows[1].light_off_mm && bright_pixels() > 0; });
    EXPECT_TRUE(lit.rows[0].hidden);
    EXPECT_FALSE(lit.rows[0].light_off_mm);
}

// The second press comes before the first one's turn: neither is lost.
TEST_F(LiveSessionTest, TrackAndAtOnceACheckOfTheSkinAreBothDone) {
    followed();
    session->post(OperatorAction::stop);
    wait_for(*session, "Track", [](const OperatorModel& m) { return m.track.enabled; });
    hold();
    ASSERT_EQ(session->post(OperatorAction::track), "");
    ASSERT_EQ(session->post(OperatorAction::check_skin), "");
    held = false;
    wait_for(*session, "the check", [](const OperatorModel& m) {
        return !m.evidence.empty() && m.evidence.front().starts_with("Skin checked");
    });
    wait_for(*session, "light", [&](const OperatorModel&) { return session->projecting(); });
}

// A camera stumbles while the press still waits: the light comes back, and must not look as if the skin was checked.
TEST_F(LiveSessionTest, ACheckOfTheSkinThatALostCameraOvertookIsSaidNotToHaveBeen) {
    followed();
    hold();
    session->post(OperatorAction::check_skin);
    lost = true;
    held = false;
    wait_for(*session, "the words", [](const OperatorModel& m) {
        return !m.evidence.empty() &&
               m.evidence.front() == "The skin was not checked: left camera: no frame came; check it again.";
    });
    wait_for(*session, "the light again", [](const OperatorModel& m) { return m.check_skin; });
}

// Stripes took the plan's place: what was measured before them is not of the light after them.
TEST_F(LiveSessionTest, AfterACheckOfTheSkinTheLightIsMeasuredAnew) {
    followed();
    wait_for(*session, "the button", [](const OperatorModel& m) { return m.check_skin; });
    ASSERT_EQ(session->post(OperatorAction::check_skin), "");
    wait_for(*session, "the check", [](const OperatorModel& m) {
        return !m.evidence.empty() && m.evidence.front().starts_with("Skin checked");
    });
    EXPECT_EQ(counts.other_light, 1);
}

class LiveSessionWithSlippedMarkers : public LiveSessionTest {
protected:
    std::unique_ptr<Room> made_room() override {
        auto made = std::make_unique<test::SlippingRoom>(room);
        entered = made.get();
        return made;
    }
    OperatorModel refused() {
        return wait_for(*session, "the refusal",
                        [](const OperatorModel& m) { return m.status.kind == StatusKind::refused && m.track.enabled; });
    }
    test::SlippingRoom* entered = nullptr;  ///< once the session is ready
};

// Somebody pressed Freeze on the projector's remote control: nothing that is ordered reaches the skin any more. The
// patient moves meanwhile.
class LiveSessionWithAFrozenProjector : public LiveSessionTest {
protected:
    std::unique_ptr<Room> made_room() override {
        auto made = std::make_unique<SimulatedRoom>(test::example_case().volume, test::example_case().prepared.plan,
                                                    room, 5, "frozen");
        entered = made.get();
        return made;
    }
    Room* entered = nullptr;  ///< once the session is ready
};

TEST_F(LiveSessionWithAFrozenProjector, DarkSaysThatTheLightDoesNotGoOut) {
    followed();
    hold();
    entered->begin_fault();
    held = false;
    session->post(OperatorAction::dark);
    EXPECT_EQ(session->model().status.kind, StatusKind::dark) << "at first nobody can know";
    const OperatorModel lit =
        wait_for(*session, "the light", [](const OperatorModel& m) { return m.status.kind == StatusKind::refused; });
    EXPECT_TRUE(says(lit, "does not go out")) << lit.status.headline;
    EXPECT_TRUE(says(lit, "cover the projector's lens")) << "what to do now stands there";
    EXPECT_TRUE(counts.light_stays_now) << "others are told, too";
    EXPECT_EQ(session->post(OperatorAction::track), "") << "the match is kept";
    wait_for(*session, "light", [](const OperatorModel& m) { return !says(m, "does not go out"); });
    EXPECT_FALSE(counts.light_stays_now);
}

// All markers slipped together: they agree with each other, and the light with them; only the skin tells. From then on
// there is no light by that match, however often Track is pressed.
TEST_F(LiveSessionWithSlippedMarkers, SkinThatLiesAsideForbidsLightUntilTheNextScan) {
    followed();
    hold();
    entered->slip();
    held = false;
    wait_for(*session, "the button", [](const OperatorModel& m) { return m.check_skin; });
    ASSERT_EQ(session->post(OperatorAction::check_skin), "");
    const OperatorModel first = refused();
    EXPECT_TRUE(says(first, "skin")) << first.status.headline;
    EXPECT_EQ(first.next, OperatorAction::scan) << "Enter and the pedal lead to a new scan";
    EXPECT_FALSE(first.do_register.enabled);
    EXPECT_EQ(session->post(OperatorAction::do_register), "Register is not possible now: scan first.")
        << "a match on the scan from before the slip is as far off as this one";
    EXPECT_EQ(bright_pixels(), -1);
    const int updates = counts.since;
    for (int press = 1; press <= 3; ++press) {
        const int before = counts.forbidden;
        EXPECT_EQ(session->post(OperatorAction::track), "") << "there for who knows better";
        wait_for(*session, "the gate", [&](const OperatorModel&) {
            EXPECT_EQ(bright_pixels(), -1);
            return counts.forbidden > before;
        });
        const OperatorModel again = refused();
        EXPECT_EQ(again.status.headline, first.status.headline);
        EXPECT_EQ(again.next, OperatorAction::scan);
        EXPECT_FALSE(again.light_on);
        EXPECT_EQ(bright_pixels(), -1);
    }
    EXPECT_EQ(counts.since, updates) << "nothing was even drawn";
    followed();  // scan, match, Track: there is light
    EXPECT_GT(bright_pixels(), 0);
}

}  // namespace
}  // namespace planlight
