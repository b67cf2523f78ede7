// A projector that was unplugged in a session: light comes back when all is as it was, and else stays away.
#include <gtest/gtest.h>

#include <algorithm>

#include "app/live/live_session.h"
#include "app/live/simulated_room.h"
#include "tests/app/played_session.h"

namespace planlight {
namespace {

using test::wait_for;

/// The projector is unplugged in the middle of a session, and comes back.
class ProjectorAway : public ::testing::Test {
protected:
    void SetUp() override {
        if (!test::example_case().there) GTEST_SKIP() << "the package invesalius-examples is not installed";
    }
    /// Follows until the light is green (and, with a fault, until it is not any more), then the projector is away;
    /// gives what is said once Track was pressed again. `hidden`: items that were hidden meanwhile.
    static OperatorModel come_back(const std::string& fault, std::size_t hidden = 0) {
        simulation::RoomSettings room;
        room.preset = simulation::Preset::paper;
        room.seed = 23;
        const Case& the_case = test::example_case().prepared;
        const CaseDrawing drawing(the_case);
        LiveSession session(
            [&](const RoomProgress&) {
                return std::make_unique<SimulatedRoom>(test::example_case().volume, the_case.plan, room, 5, fault);
            },
            the_case, drawing, {});
        wait_for(session, "Scan", [](const OperatorModel& m) { return m.scan.enabled; });
        session.post(OperatorAction::scan);
        wait_for(session, "the scan", [](const OperatorModel& m) { return m.do_register.enabled; });
        session.post(OperatorAction::do_register);
        wait_for(session, "the match", [](const OperatorModel& m) { return m.track.enabled; });
        session.post(OperatorAction::track);
        std::string said;
        bool green = false;
        wait_for(session, "green light", [&](const OperatorModel& m) {
            if (m.confirm && m.confirm_words != said) {
                said = m.confirm_words;
                session.post(OperatorAction::confirm);
            }
            green |= m.status.kind == StatusKind::aligned;
            return green && (fault.empty() || m.status.kind != StatusKind::aligned);
        });
        EXPECT_TRUE(green);
        for (std::size_t item = 0; item < hidden; ++item)
            EXPECT_EQ(session.post_item(OperatorAction::hide_item, item), "");
        wait_for(session, "what is hidden", [&](const OperatorModel& m) {
            return std::count_if(m.rows.begin(), m.rows.end(), [](const PlanRow& row) { return row.hidden; }) ==
                   static_cast<std::ptrdiff_t>(hidden);
        });
        session.look_before_light();
        session.post(OperatorAction::dark);
        wait_for(session, "DARK", [&](const OperatorModel& m) { return m.track.enabled && !session.projecting(); });
        session.post(OperatorAction::track);
        wait_for(session, "light or a refusal",
                 [&](const OperatorModel& m) { return session.projecting() || m.status.kind == StatusKind::refused; });
        const OperatorModel model = session.model();
        EXPECT_EQ(session.projecting(), model.status.kind != StatusKind::refused);
        if (model.status.kind == StatusKind::refused) {
            // And so it stays: another press looks again.
            session.post(OperatorAction::track);
            wait_for(session, "another look",
                     [](const OperatorModel& m) { return m.status.kind != StatusKind::refused; });
            wait_for(session, "the refusal",
                     [](const OperatorModel& m) { return m.status.kind == StatusKind::refused; });
            EXPECT_FALSE(session.projecting());
        }
        // The scan was given up for the short one: Register says so, and does not take the match with it.
        EXPECT_FALSE(session.model().do_register.enabled);
        EXPECT_NE(session.post(OperatorAction::do_register), "");
        return model;
    }
};

TEST_F(ProjectorAway, TheLightComesBackWhenAllIsAsItWas) {
    EXPECT_NE(come_back({}).status.kind, StatusKind::refused);
}

TEST_F(ProjectorAway, WhatWasHiddenIsHiddenStillWhenTheLightComesBack) {
    const OperatorModel model = come_back({}, 2);
    EXPECT_NE(model.status.kind, StatusKind::refused);
    ASSERT_GT(model.rows.size(), 2U);
    for (std::size_t i = 0; i < model.rows.size(); ++i) EXPECT_EQ(model.rows[i].hidden, i < 2) << i;
    for (const Stroke& stroke : model.scene.plan->strokes) EXPECT_GT(stroke.item, 1) << "nor in the 3-D view";
}

TEST_F(ProjectorAway, AProjectorThatWasMovedMeanwhileStaysDark) {
    const OperatorModel model = come_back("projector");
    EXPECT_EQ(model.status.kind, StatusKind::refused);
    EXPECT_NE(model.status.headline.find("the rig has moved"), std::string::npos) << model.status.headline;
}

}  // namespace
}  // namespace planlight
