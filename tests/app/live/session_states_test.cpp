#include "app/live/session_states.h"

#include <gtest/gtest.h>

#include <fstream>
#include <queue>
#include <set>
#include <sstream>

#include "tests/app/live/states_page.h"
#include "tests/app/windows/fake_model.h"

namespace planlight {
namespace {

constexpr OperatorAction kPresses[] = {
    OperatorAction::scan, OperatorAction::do_register, OperatorAction::use_landmarks, OperatorAction::track,
    OperatorAction::stop, OperatorAction::dark,        OperatorAction::confirm,       OperatorAction::check_skin};
constexpr SessionHappening kHappenings[] = {SessionHappening::room_made,     SessionHappening::scan_done,
                                            SessionHappening::match_found,   SessionHappening::match_unsure,
                                            SessionHappening::match_refused, SessionHappening::landmarks_seen,
                                            SessionHappening::skin_checked,  SessionHappening::match_offered,
                                            SessionHappening::match_resumed, SessionHappening::failed};

std::string name(SessionState state) {
    return view_of(state).name;
}

/// The model of a session in which everything is known and lit, then entered into `state`.
OperatorModel entered(SessionState state) {
    static const OperatorModel full = test::fake_model();
    OperatorModel blank = full, model = full;
    blank.scene.cloud = nullptr;
    blank.scene.cloud_distance_mm = nullptr;
    blank.scene.markers = nullptr;
    blank.scene.light = nullptr;
    blank.fit = std::nullopt;
    blank.evidence = {"Warning of the preparation."};
    for (PlanRow& row : blank.rows) row.predicted_error_mm = row.light_off_mm = std::nullopt;
    enter(state, blank, model);
    return model;
}

const ButtonState& button_of(const OperatorModel& model, const std::string& label) {
    return label == "Scan"       ? model.scan
           : label == "Register" ? model.do_register
           : label == "Track"    ? model.track
                                 : model.stop;
}

TEST(SessionStates, EveryPressInEveryStateLeadsSomewhereOrIsAnsweredWithAReason) {
    for (const SessionState state : kSessionStates)
        for (const OperatorAction press : kPresses) {
            if (after_press(state, press)) continue;
            EXPECT_GT(why_not(state, press).size(), 20U) << name(state);
            EXPECT_EQ(why_not(state, press).back(), '.') << name(state);
        }
}

TEST(SessionStates, AButtonIsEnabledExactlyWhereItsPressIsTakenAndElseSaysWhy) {
    for (const SessionState state : kSessionStates) {
        const OperatorModel model = entered(state);
        EXPECT_EQ(model.scan.enabled, after_press(state, OperatorAction::scan).has_value()) << name(state);
        EXPECT_EQ(model.do_register.enabled, after_press(state, OperatorAction::do_register).has_value());
        EXPECT_EQ(model.track.enabled, after_press(state, OperatorAction::track).has_value()) << name(state);
        EXPECT_EQ(model.check_skin, after_press(state, OperatorAction::check_skin).has_value()) << name(state);
        for (const ButtonState* button : {&model.scan, &model.do_register, &model.track, &model.stop})
            EXPECT_NE(button->enabled, !button->why_not.empty()) << name(state);
    }
}

// "Press Register" beside a grey Register: seen by every new user.
TEST(SessionStates, NoSentenceSpeaksOfAButtonThatIsNotEnabled) {
    for (const SessionState state : kSessionStates) {
        const OperatorModel model = entered(state);
        for (const Status& status : {model.status, dark_status(state)}) {
            std::string said = status.headline;
            for (const std::string& detail : status.details) said += " " + detail;
            for (const char* label : {"Scan", "Register", "Track", "Stop"})
                if (said.find("ress " + std::string(label)) != std::string::npos ||
                    said.find(std::string(label) + " and DARK") != std::string::npos) {
                    // After DARK in a state that lights, the session is in the state that it leads to.
                    const SessionState then = after_press(state, OperatorAction::dark).value();
                    const OperatorModel now = status.kind == StatusKind::dark ? entered(then) : model;
                    if (status.kind == StatusKind::dark && then != state) continue;
                    EXPECT_TRUE(button_of(now, label).enabled) << name(state) << ": " << said;
                }
        }
    }
}

TEST(SessionStates, WhatLeadsOnIsEnabled) {
    for (const SessionState state : kSessionStates)
        if (const OperatorAction next = entered(state).next; next != OperatorAction::none) {
            EXPECT_TRUE(after_press(state, next)) << name(state);
        }
}

TEST(SessionStates, DarkAndStopLeadFromEverywhereToAStateWithoutLightFiguresOrQuestions) {
    for (const SessionState state : kSessionStates)
        for (const OperatorAction press : {OperatorAction::dark, OperatorAction::stop}) {
            const auto dark = after_press(state, press);
            ASSERT_TRUE(dark) << name(state);
            EXPECT_FALSE(view_of(*dark).lights) << name(state);
            const OperatorModel model = entered(*dark);
            EXPECT_EQ(model.scene.light, nullptr);
            EXPECT_EQ(model.figures, Figures{});
            EXPECT_FALSE(model.light_on);
            EXPECT_FALSE(model.check_skin);
        }
}

TEST(SessionStates, AnAbortedScanLeavesNothingOfTheFormerMatch) {
    const SessionState after_it = after_press(SessionState::scanning, OperatorAction::dark).value();
    EXPECT_EQ(after_it, after(SessionState::scanning, SessionHappening::failed)) << "ended or refused, the same";
    for (const SessionState state : {SessionState::scanning, after_it}) {
        const OperatorModel model = entered(state);
        EXPECT_EQ(model.scene.cloud, nullptr);
        EXPECT_FALSE(model.fit);
        EXPECT_FALSE(model.landmarks);
        EXPECT_FALSE(model.do_register.enabled);
        EXPECT_FALSE(model.track.enabled);
        EXPECT_EQ(model.evidence, std::vector<std::string>{"Warning of the preparation."});
        for (const PlanRow& row : model.rows) EXPECT_FALSE(row.predicted_error_mm || row.light_off_mm) << row.name;
    }
    EXPECT_TRUE(entered(after_it).scan.enabled) << "it can be begun again";
}

// A match of an earlier session is gone on with: its scan was another session's, and there is nothing to register.
TEST(SessionStates, WithoutAScanOfThisSessionRegisterWaitsForOne) {
    const OperatorModel blank;
    for (const SessionState state : kSessionStates) {
        if (!view_of(state).has_scan) continue;
        OperatorModel model;
        model.landmarks.emplace();
        enter(state, blank, model, false);
        EXPECT_FALSE(model.do_register.enabled) << name(state);
        EXPECT_FALSE(model.landmarks) << name(state) << ": they would be clicked on nothing";
        for (const OperatorAction press : {OperatorAction::do_register, OperatorAction::use_landmarks}) {
            EXPECT_FALSE(after_press(state, press, false)) << name(state);
            EXPECT_FALSE(why_not(state, press, false).empty()) << name(state);
        }
    }
    EXPECT_TRUE(after_press(SessionState::found, OperatorAction::do_register, true));
    EXPECT_EQ(why_not(SessionState::found, OperatorAction::do_register, false),
              "Register is not possible now: scan first.");
}

TEST(SessionStates, AnItemOfTheMomentNeedsAMatchAndGoesWithIt) {
    const OperatorModel blank;
    for (const SessionState state : kSessionStates) {
        OperatorModel model;
        model.item_of_moment = 1;
        enter(state, blank, model);
        EXPECT_EQ(model.may_light_item, view_of(state).has_match) << name(state);
        EXPECT_EQ(model.item_of_moment.has_value(), view_of(state).has_match) << name(state);
        const auto stays = view_of(state).has_match ? std::optional(state) : std::nullopt;
        for (const OperatorAction press :
             {OperatorAction::light_item, OperatorAction::hide_item, OperatorAction::show_item}) {
            EXPECT_EQ(after_press(state, press), stays) << name(state);
            EXPECT_EQ(why_not(state, press).empty(), view_of(state).has_match) << name(state);
        }
    }
}

TEST(SessionStates, FiguresStayOnlyWhereLightIsJudged) {
    for (const SessionState state : kSessionStates) {
        const bool judged = state == SessionState::following || state == SessionState::verifying;
        EXPECT_EQ(entered(state).figures == Figures{}, !judged) << name(state);
    }
}

// Also a scan's stripes fall on the patient: by a stray Alt-F4 they must not go, and the scan with them.
TEST(SessionStates, ClosingTheWindowIsAskedAboutWhereverThereMayBeLight) {
    for (const SessionState state : kSessionStates)
        EXPECT_EQ(entered(state).light_on, view_of(state).lights) << name(state);
    for (const SessionState state : {SessionState::scanning, SessionState::checking_skin, SessionState::looking_again})
        EXPECT_TRUE(entered(state).light_on) << name(state);
}

TEST(SessionStates, AMatchIsShownOnlyWhereThereIsOne) {
    for (const SessionState state : kSessionStates) {
        EXPECT_EQ(entered(state).fit.has_value(), view_of(state).has_match) << name(state);
        EXPECT_EQ(entered(state).landmarks.has_value(), view_of(state).has_scan) << name(state);
    }
}

TEST(SessionStates, EveryStateIsReachedAndLeadsOnToLight) {
    const auto reached_from = [](SessionState start) {
        std::set<SessionState> reached{start};
        std::queue<SessionState> open({start});
        while (!open.empty()) {
            const SessionState state = open.front();
            open.pop();
            std::vector<SessionState> next;
            for (const OperatorAction press : kPresses)
                if (const auto then = after_press(state, press)) next.push_back(*then);
            for (const SessionHappening happening : kHappenings) next.push_back(after(state, happening));
            for (const SessionState then : next)
                if (reached.insert(then).second) open.push(then);
        }
        return reached;
    };
    EXPECT_EQ(reached_from(SessionState::opening).size(), kSessionStates.size());
    for (const SessionState state : kSessionStates)
        EXPECT_TRUE(reached_from(state).contains(SessionState::following)) << name(state);
}

TEST(SessionStates, FromReadyToTheFirstVerifiedLineInSixPressesOfWhatStandsOut) {
    SessionState state = after(SessionState::opening, SessionHappening::room_made);
    int presses = 0;
    const auto press = [&](OperatorAction action) {
        EXPECT_EQ(entered(state).next == OperatorAction::none ? action : entered(state).next, action);
        state = after_press(state, action).value();
        ++presses;
    };
    press(OperatorAction::scan);
    state = after(state, SessionHappening::scan_done);
    press(OperatorAction::do_register);
    state = after(state, SessionHappening::match_found);
    press(OperatorAction::track);
    for (int landmark = 0; landmark < 3; ++landmark) press(OperatorAction::confirm);  // show, first, second
    state = after(state, SessionHappening::landmarks_seen);
    EXPECT_EQ(state, SessionState::following);
    EXPECT_EQ(presses, 6);
}

TEST(SessionStates, ThePageOfTheGuideIsTheTable) {
    std::ifstream file(std::string(PLANLIGHT_SOURCE_FOLDER) + "/app/guide/states.md");
    std::stringstream page;
    page << file.rdbuf();
    EXPECT_EQ(page.str(), test::states_page()) << "write it anew: build/tests/app/list_states > app/guide/states.md";
}

}  // namespace
}  // namespace planlight
