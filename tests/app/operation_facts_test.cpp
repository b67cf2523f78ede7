// What a recording tells of an operation: figures that were put in by hand come out again.
#include <functional>

#include "planning_io/types/error.h"
#include "tests/app/recording_by_hand.h"

namespace planlight {
namespace {

using Operation = RecordingByHand;

TEST_F(Operation, TellsWhatWasShownWhenAndHowFarOff) {
    match();
    event({{"what", "gate"}, {"call", "verify"}, {"utc", "x"}});
    for (int i = 0; i <= 20; ++i) lit(0.1 + 0.01 * i, 0.4, "aligned");
    dark("the last pose is 83 ms old (at most 75 ms)");
    dark("the last pose is 91.5 ms old (at most 75 ms)");
    for (int i = 0; i < 9; ++i) dark("the patient is not tracked");
    for (int i = 0; i < 10; ++i) lit(0.2, 0.4, "look", false);
    const OperationFacts f = facts();
    ASSERT_EQ(f.items.size(), 2u);
    const OperationItem &line = f.items[0], &hole = f.items[1];
    EXPECT_EQ(line.name, "Line");
    ASSERT_EQ(line.shown.size(), 2u) << "1.1 s of darkness is a break";
    EXPECT_NEAR(line.shown[0].first, 0.1, 1e-9);
    EXPECT_NEAR(line.shown[0].second, 2.1, 1e-9);
    EXPECT_NEAR(line.shown[1].second, 4.2, 1e-9);
    EXPECT_EQ(hole.shown.size(), 1u) << "the second time its light did not reach the skin";
    EXPECT_EQ(*line.predicted_mm, 0.5);
    EXPECT_FALSE(hole.predicted_mm) << "null is not known, never 0";
    EXPECT_EQ(line.measured_mm.size(), 31u);
    EXPECT_NEAR(line.measured_mm[20], 0.3, 1e-12);
    EXPECT_NEAR(f.lit_s, 3.0, 1e-9) << "20 steps of the first light, 10 of the second";
    EXPECT_NEAR(f.aligned_s, 2.0, 1e-9);
    EXPECT_NEAR(f.look_s, 1.0, 1e-9);
    ASSERT_EQ(f.dark.size(), 2u) << "the same reason with other numbers is one reason";
    EXPECT_EQ(f.dark.at("the last pose is … ms old (at most … ms)").first, 1);
    EXPECT_NEAR(f.dark.at("the patient is not tracked").second, 0.9, 1e-9);
    EXPECT_EQ(f.verified, 1);
    EXPECT_EQ(f.ended, "");
}

/// A borehole at the far side: there is light, and never a ray of it for this one.
TEST_F(Operation, WhatTheLightNeverReachedIsNotShownNotForAMomentEither) {
    match();
    event({{"what", "gate"}, {"call", "verify"}, {"utc", "x"}});
    unchecked("look");
    for (int i = 0; i < 50; ++i) lit(0.2, 0.0, "aligned", false);
    const OperationFacts f = facts();
    ASSERT_EQ(f.items.size(), 2u);
    EXPECT_NEAR(f.items[0].shown_s, 5.0, 1e-9);
    ASSERT_EQ(f.items[0].shown.size(), 1u);
    EXPECT_NEAR(f.items[0].shown[0].first, 0.1, 1e-9) << "the light before the first look was that of the line";
    EXPECT_TRUE(f.items[1].shown.empty());
    const auto reasons = verdict_of(f).reasons;
    EXPECT_NE(std::find(reasons.begin(), reasons.end(), "Not shown: Hole."), reasons.end());
}

TEST_F(Operation, TellsWhatAPersonHidAndShowedAgain) {
    const auto ask = [&](const char* call, int which) {
        event({{"what", "asked"}, {"call", call}, {"which", which}, {"utc", "2026-03-14T09:33:00Z"}});
    };
    match();
    ask("hide_item", 1);
    ask("light_item", 0);
    ask("light_item", 1);  // alone bright, so lit again
    ask("hide_item", 0);
    ask("show_item", 0);
    ask("hide_item", 0);
    ask("show_item", -1);
    std::vector<std::string> said;
    for (const OperationEvent& one : facts().said) said.push_back(one.what);
    EXPECT_EQ(said,
              (std::vector<std::string>{"\"Hole\" was hidden: it was not lit.", "\"Hole\" was shown again.",
                                        "\"Line\" was hidden: it was not lit.", "\"Line\" was shown again.",
                                        "\"Line\" was hidden: it was not lit.", "The whole plan was shown again."}));
}

TEST_F(Operation, WhatNoCameraLookedAtIsNeitherShownNorNotShown) {
    match();
    for (int i = 0; i < 50; ++i) unchecked("look");
    const OperationFacts f = facts();
    EXPECT_NEAR(f.lit_s, 4.9, 1e-9);
    EXPECT_TRUE(f.items[0].shown.empty());
    EXPECT_TRUE(json::parse(operation_json(f))["items"][0]["shown"].is_null());
    bool told = false;
    for (const std::string& reason : verdict_of(f).reasons) {
        told |= reason.starts_with("Whether the light reached it is not known");
        EXPECT_FALSE(reason.starts_with("Not shown")) << reason;
    }
    EXPECT_TRUE(told);
}

TEST_F(Operation, WhoseSkinSlidIsNotGood) {
    match();
    skin_check(0.4), skin_check(1.9), skin_check(0.3);
    event({{"what", "skin_checked"}, {"known", false}, {"why_not", "it moved"}, {"off_mm", 7.0}});
    const OperationFacts f = facts();
    EXPECT_EQ(f.skin_off_mm, 1.9) << "the worst that is known";
    EXPECT_EQ(json::parse(operation_json(f))["skin_off_mm"], 1.9);
}

/// What was seen near the strokes' places then is other light: 8 mm are not reported as 0.35.
TEST_F(Operation, LightThatWasFoundFarAsideIsReportedAsFarAside) {
    match();
    lit(0.35, 0.35, "look");
    const std::size_t at = chunks_.size() - 2;
    json far = json::parse(chunks_[at].payload);
    far["check"]["far_mm"] = 8.0;
    chunks_[at].payload = far.dump();
    const OperationFacts f = facts();
    EXPECT_EQ(f.light_off_mm, std::vector<double>{8.0});
    EXPECT_EQ(f.items[0].measured_mm, std::vector<double>{8.0});
    EXPECT_NE(verdict_of(f).kind, OperationVerdict::Kind::good);
}

TEST_F(Operation, AFigureThatIsNotKnownIsLeftOutNeverZero) {
    match();
    lit(0.5, 0.5, "aligned");
    const std::size_t at = chunks_.size() - 2;
    json unknown = json::parse(chunks_[at].payload);
    unknown["check"]["off_mm"] = nullptr;
    unknown["check"]["items"][0][3] = nullptr;
    chunks_[at].payload = unknown.dump();
    skin_check(nullptr);
    const OperationFacts f = facts();
    EXPECT_TRUE(f.light_off_mm.empty());
    EXPECT_TRUE(f.items[0].measured_mm.empty());
    EXPECT_EQ(f.items[1].measured_mm, std::vector<double>{0.5});
    EXPECT_FALSE(f.skin_off_mm);
}

TEST_F(Operation, LightOnALandmarkIsNoLightOfThePlan) {
    match();
    lit(0.1, 0.1, "aligned");
    for (int i = 0; i < 10; ++i) lit(0.1, 0.1, "aligned");
    event({{"what", "asked"}, {"call", "light_landmark"}, {"which", 0}});
    for (int i = 0; i < 100; ++i) lit(0.1, 0.1, "look");
    event({{"what", "asked"}, {"call", "light_landmark"}, {"which", -1}});
    for (int i = 0; i < 10; ++i) lit(0.1, 0.1, "aligned");
    const OperationFacts f = facts();
    EXPECT_NEAR(f.lit_s, 1.9, 1e-9) << "10 steps before the landmark, 9 after it";
    EXPECT_NEAR(f.aligned_s, 1.9, 1e-9);
    EXPECT_NEAR(f.look_s, 0, 1e-9);
    EXPECT_NEAR(f.items[0].shown_s, 1.9, 1e-9);
}

TEST_F(Operation, TwoItemsOfOneNameAreTwo) {
    match();
    json twice = json::parse(chunks_.back().payload);
    twice["items"] = {"Hole", "Hole"};
    twice["predicted_mm"] = {0.5, 0.7};
    chunks_.back().payload = twice.dump();
    lit(0.1, 3.0, "aligned");
    const OperationFacts f = facts();
    ASSERT_EQ(f.items.size(), 2u);
    EXPECT_EQ(f.items[0].measured_mm, std::vector<double>{0.1});
    EXPECT_EQ(f.items[1].measured_mm, std::vector<double>{3.0});
    EXPECT_EQ(*f.items[1].predicted_mm, 0.7);
}

TEST_F(Operation, AMatchThatWasNotUsedLeavesWhatWasPredictedOfTheOneBefore) {
    match("yes");
    lit(0.1, 0.1, "aligned");
    match("no");
    match("ask");
    EXPECT_EQ(facts().items[0].predicted_mm, 0.5);
}

TEST_F(Operation, ADoubtfulMatchPredictsFromItsConfirmationOn) {
    match("ask");
    EXPECT_FALSE(facts(false).items[0].predicted_mm);
    event({{"what", "asked"}, {"call", "confirm"}, {"utc", "x"}});
    EXPECT_EQ(facts(false).items[0].predicted_mm, 0.5);
}

TEST_F(Operation, AProjectorThatWasLostIsNobodysPress) {
    event({{"what", "pressed"}, {"action", "projector_lost"}, {"utc", "x"}});
    const OperationFacts f = facts();
    EXPECT_TRUE(f.said.empty()) << "nobody said or did that";
    ASSERT_EQ(f.refusals.size(), 1u);
    EXPECT_EQ(f.refusals[0].what, "The projector was lost, and the session made dark.");
}

TEST_F(Operation, WhoSaidThatTheLightIsRightIsTold) {
    const auto press = [&] { event({{"what", "pressed"}, {"action", "confirm"}, {"utc", "x"}}); };
    const auto verify = [&] { event({{"what", "gate"}, {"call", "verify"}, {"utc", "x"}}); };
    match("ask");
    press();
    event({{"what", "asked"}, {"call", "confirm"}, {"utc", "x"}});
    step_ += 100;
    verify();
    press();  // noted by another thread, at once after it
    step_ += 100;
    verify();
    step_ += 100;
    press();  // of something else
    const OperationFacts f = facts();
    ASSERT_EQ(f.said.size(), 3u);
    EXPECT_EQ(f.said[0].what, "By a press the match was said to fit.");
    EXPECT_EQ(f.said[1].what, "By a press the light on landmarks was said to be right.");
    EXPECT_EQ(f.said[2].what, "By the program itself, without a press, the light on landmarks was said to be right.");
    EXPECT_EQ(f.verified, 2);
    EXPECT_EQ(f.verified_by_program, 1);
}

TEST_F(Operation, WhoPressedIsNamedWhereHeWasNamed) {
    RecordingHead head = head_of(chunks_[0].payload, "by hand");
    EXPECT_EQ(operator_text(head), "Ada (account of the computer)") << "an account presses nothing";
    head.operator_name = "Dr. Anna Meier", head.operator_named = true;
    chunks_[0].payload = text_of(head);
    match("ask");
    event({{"what", "pressed"}, {"action", "confirm"}, {"utc", "x"}});
    event({{"what", "asked"}, {"call", "confirm"}, {"utc", "x"}});
    const OperationFacts f = facts();
    EXPECT_EQ(f.said.at(0).what, "By a press (Dr. Anna Meier) the match was said to fit.");
    EXPECT_EQ(operator_text(f.head), "Dr. Anna Meier");
    EXPECT_EQ(json::parse(operation_json(f))["operator"], "Dr. Anna Meier");
    EXPECT_EQ(operator_text(without_names(head)), "");
}

TEST_F(Operation, SaysByWhichLimitsTheLightWasJudgedAndHowLateItWasHeldToBe) {
    RecordingHead head = head_of(chunks_[0].payload, "by hand");
    EXPECT_EQ(settings_in_words(head), "") << "a recording of before does not tell";
    head.settings =
        R"({"light_delay_ms": 31.5, "light_delay_from": "projector file", "gate": {"warn_mm": 1, "stop_mm": 2}})";
    chunks_[0].payload = text_of(head);
    const OperationFacts f = facts();
    EXPECT_EQ(settings_in_words(f.head),
              "gate: amber above 1 mm, dark above 2 mm; projector latency 31.5 ms (projector file)");
    EXPECT_EQ(json::parse(operation_json(f))["settings"]["light_delay_ms"], 31.5);
    EXPECT_NE(page_of(f).find("projector latency 31.5 ms"), std::string::npos);
    head.settings = R"({"light_delay_ms": "late"})";
    EXPECT_EQ(settings_in_words(head), "") << "another program's";
}

TEST_F(Operation, ItsLastWordCountsWhatTheDiskDidNotTake) {
    add(chunk_types::kLost, R"({"chunks": 2, "bytes": 10})");
    EXPECT_EQ(facts(true, R"({"dropped_chunks": 5, "dropped_bytes": 20})").lost_chunks, 5u);
}

TEST_F(Operation, IsGoodOnlyWhereItWasMeasuredVerifiedAndWhole) {
    using Kind = OperationVerdict::Kind;
    const auto verdict_with = [](const std::function<void(OperationFacts&)>& spoil) {
        OperationFacts f;
        f.updates = 100, f.lit_s = 10, f.aligned_s = 9.5, f.verified = 1;
        f.items.push_back({"Line", {{0, 10}}, 10, 0.5, std::vector<double>(50, 0.2), true});
        spoil(f);
        return verdict_of(f).kind;
    };
    EXPECT_EQ(verdict_with([](OperationFacts&) {}), Kind::good);
    EXPECT_EQ(verdict_with([](OperationFacts& f) { f.verified = 0; }), Kind::look);
    EXPECT_EQ(verdict_with([](OperationFacts& f) { f.verified_by_program = 1; }), Kind::look) << "nobody looked";
    EXPECT_EQ(verdict_with([](OperationFacts& f) { f.stops = 1; }), Kind::look);
    EXPECT_EQ(verdict_with([](OperationFacts& f) { f.aligned_s = 5; }), Kind::look);
    EXPECT_EQ(verdict_with([](OperationFacts& f) { f.ended = "It was cut."; }), Kind::look);
    EXPECT_EQ(verdict_with([](OperationFacts& f) { f.lost_chunks = 1; }), Kind::look);
    EXPECT_EQ(verdict_with([](OperationFacts& f) { f.items[0].measured_mm.clear(); }), Kind::look);
    EXPECT_EQ(verdict_with([](OperationFacts& f) { f.items[0].measured_mm.assign(50, 1.5); }), Kind::look);
    EXPECT_EQ(verdict_with([](OperationFacts& f) { f.items[0].measured_mm.assign(50, 2.5); }), Kind::stop);
    EXPECT_EQ(verdict_with([](OperationFacts& f) { f.lit_s = 0; }), Kind::look);
    EXPECT_EQ(verdict_with([](OperationFacts& f) { f.skin_off_mm = 0.9; }), Kind::good);
    EXPECT_EQ(verdict_with([](OperationFacts& f) { f.skin_off_mm = 1.9; }), Kind::look);
    EXPECT_EQ(verdict_with([](OperationFacts& f) { f.skin_off_mm = 2.1; }), Kind::stop);
    EXPECT_EQ(verdict_with([](OperationFacts& f) { f.skin_off_mm = 2.1, f.lit_s = 0; }), Kind::stop)
        << "what is worst is said, shown or not";
    EXPECT_EQ(verdict_with([](OperationFacts& f) { f.matches.push_back({0, "", "ask", {}, 0, 0}); }), Kind::look);
}

TEST_F(Operation, OfARecordingThatWasCutIsToldUpToThereAndSaysSo) {
    match();
    lit(0.1, 0.2, "aligned");
    lit(0.1, 0.2, "aligned");
    const OperationFacts f = facts(false);
    EXPECT_EQ(f.updates, 2);
    EXPECT_NE(f.ended.find("without a closing word"), std::string::npos) << f.ended;
    EXPECT_FALSE(f.damaged);
}

TEST_F(Operation, EventsThatCannotBeUnderstoodAreRefused) {
    event({{"what", "updated"}, {"at_ns", "soon"}});
    EXPECT_THROW(facts(), DamagedFileError);
}

}  // namespace
}  // namespace planlight
