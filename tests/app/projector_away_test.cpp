// A projector that was unplugged in a session: light comes back when all is as it was, and else stays away.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "app/live/live_session.h"
#include "app/live/simulated_room.h"
#include "app/recording/recording_head.h"
#include "app/recording/replay_session.h"
#include "app/recording/resume_offer.h"
#include "planning_io/case/rig_file.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/types/error.h"
#include "registration/simulation/simulated_rig.h"
#include "tests/app/played_session.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using simulation::SimulatedRig;

/// The projector is unplugged in the middle of a session, and comes back.
class ProjectorAway : public ::testing::Test {
protected:
    void SetUp() override {
        if (!test::example_case().there) GTEST_SKIP() << "the package invesalius-examples is not installed";
    }
    template <class Holds>
    static void wait(LiveSession& session, Holds holds) {
        for (int i = 0; i < 30000 && !holds(session.model()); ++i) {
            session.rethrow_fault();
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
    }
    /// Follows until the light is green (and, with a fault, until it is not any more), then the projector is away;
    /// gives what is said once Track was pressed again.
    static OperatorModel come_back(const std::string& fault) {
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
        wait(session, [](const OperatorModel& m) { return m.scan.enabled; });
        session.post(OperatorAction::scan);
        wait(session, [](const OperatorModel& m) { return m.do_register.enabled; });
        session.post(OperatorAction::do_register);
        wait(session, [](const OperatorModel& m) { return m.track.enabled; });
        session.post(OperatorAction::track);
        std::string said;
        bool green = false;
        wait(session, [&](const OperatorModel& m) {
            if (m.confirm && m.confirm_words != said) {
                said = m.confirm_words;
                session.post(OperatorAction::confirm);
            }
            green |= m.status.kind == StatusKind::aligned;
            return green && (fault.empty() || m.status.kind != StatusKind::aligned);
        });
        EXPECT_TRUE(green);
        session.look_before_light();
        session.post(OperatorAction::dark);
        wait(session, [&](const OperatorModel& m) { return m.track.enabled && !session.projecting(); });
        session.post(OperatorAction::track);
        wait(session,
             [&](const OperatorModel& m) { return session.projecting() || m.status.kind == StatusKind::refused; });
        const OperatorModel model = session.model();
        if (model.status.kind == StatusKind::refused) {
            EXPECT_FALSE(session.projecting());
            // And so it stays: another press looks again.
            session.post(OperatorAction::track);
            wait(session, [](const OperatorModel& m) { return m.status.kind != StatusKind::refused; });
            wait(session, [](const OperatorModel& m) { return m.status.kind == StatusKind::refused; });
            EXPECT_FALSE(session.projecting());
        }
        return model;
    }
};

TEST_F(ProjectorAway, TheLightComesBackWhenAllIsAsItWas) {
    EXPECT_NE(come_back({}).status.kind, StatusKind::refused);
}

TEST_F(ProjectorAway, AProjectorThatWasMovedMeanwhileStaysDark) {
    const OperatorModel model = come_back("projector");
    EXPECT_EQ(model.status.kind, StatusKind::refused);
    EXPECT_NE(model.status.headline.find("the rig has moved"), std::string::npos) << model.status.headline;
}

}  // namespace
}  // namespace planlight
