// A projector that was unplugged in a session: light comes back when all is as it was, and else stays away.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>

#include "app/live/live_session.h"
#include "app/live/simulated_room.h"
#include "app/recording/recording_head.h"
#include "app/recording/replay_session.h"
#include "app/recording/session_recorder.h"
#include "app/session_observers.h"
#include "tests/app/played_session.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

using test::wait_for;

/// What was lit of the patient's name and of the plan since the match was gone on with.
class LitAgain final : public SessionObserver {
public:
    void resumed(const Session&, const ResumeCheck&) noexcept override { resumed_ = true; }
    void updated(const Session& session, const Session::Update& update) noexcept override {
        if (!resumed_) return;
        ++updates;
        cards += update.overlay.counts.card_lit || session.card_wanted();
        whole_plans += session.hidden_items() != std::set<std::size_t>{0} || session.item_of_moment() != 1U;
    }
    std::atomic<int> updates{0}, cards{0}, whole_plans{0};

private:
    bool resumed_ = false;
};

bool asks_to_read_the_card(const OperatorModel& m) {
    return std::ranges::any_of(m.status.details,
                               [](const std::string& said) { return said.find("the card") != std::string::npos; });
}

/// The projector is unplugged in the middle of a session, and comes back.
class ProjectorAway : public ::testing::Test {
protected:
    void SetUp() override {
        if (!test::example_case().there) GTEST_SKIP() << "the package invesalius-examples is not installed";
    }
    /// Follows until the light is green (and, with a fault, until it is not any more), with the patient's name on the
    /// skin until it is verified; then one item is hidden and another alone bright, and the projector is away. Gives
    /// what is said once Track was pressed again.
    static OperatorModel come_back(const std::string& fault, SessionObserver* observer = nullptr) {
        simulation::RoomSettings room;
        room.preset = simulation::Preset::paper;
        room.seed = 23;
        const Case& the_case = test::example_case().prepared;
        CaseDrawing drawing(the_case);
        drawing.settings.card = kCard;
        LiveSession session(
            [&](const RoomProgress&) {
                return std::make_unique<SimulatedRoom>(test::example_case().volume, the_case.plan, room, 5, fault);
            },
            the_case, drawing, {}, observer);
        test::begin_to_follow(session);
        test::LandmarkWitness witness(session);
        bool green = false, card_asked_for = false;
        wait_for(session, "green light", [&](const OperatorModel& m) {
            witness.look(m);
            card_asked_for |= asks_to_read_the_card(m);
            green |= m.status.kind == StatusKind::aligned;
            return green && (fault.empty() || m.status.kind != StatusKind::aligned);
        });
        EXPECT_TRUE(green);
        EXPECT_TRUE(card_asked_for);
        EXPECT_EQ(session.post_item(OperatorAction::hide_item, 0), "");
        EXPECT_EQ(session.post_item(OperatorAction::light_item, 1), "");
        wait_for(session, "a part of the plan",
                 [](const OperatorModel& m) { return m.rows[0].hidden && m.item_of_moment == 1U; });
        session.look_before_light();
        session.post(OperatorAction::dark);
        wait_for(session, "DARK", [&](const OperatorModel& m) { return m.track.enabled && !session.projecting(); });
        session.post(OperatorAction::track);
        wait_for(session, "light or a refusal",
                 [&](const OperatorModel& m) { return session.projecting() || m.status.kind == StatusKind::refused; });
        const OperatorModel model = session.model();
        EXPECT_TRUE(model.rows[0].hidden) << "until Show, or the next match";
        EXPECT_EQ(model.item_of_moment, 1U);
        EXPECT_FALSE(asks_to_read_the_card(model)) << "it has been read";
        EXPECT_EQ(session.projecting(), model.status.kind != StatusKind::refused);
        if (session.projecting()) looked_at_again(session);
        if (model.status.kind == StatusKind::refused) {
            // And so it stays: another press looks again, and lights no more than was asked for meanwhile.
            EXPECT_EQ(session.post_item(OperatorAction::show_item, std::nullopt), "");
            wait_for(session, "the whole plan", [](const OperatorModel& m) { return !m.rows[0].hidden; });
            session.post(OperatorAction::track);
            wait_for(session, "another look",
                     [](const OperatorModel& m) { return m.status.kind != StatusKind::refused; });
            wait_for(session, "the refusal",
                     [](const OperatorModel& m) { return m.status.kind == StatusKind::refused; });
            EXPECT_FALSE(session.projecting());
            EXPECT_FALSE(session.model().rows[0].hidden);
            EXPECT_FALSE(session.model().item_of_moment);
        }
        // The scan was given up for the short one: Register says so, and does not take the match with it.
        EXPECT_FALSE(session.model().do_register.enabled);
        EXPECT_NE(session.post(OperatorAction::do_register), "");
        return model;
    }
    /// Of the light of a projector that was away a person has seen nothing: it is green once it was looked at anew.
    static void looked_at_again(LiveSession& session) {
        wait_for(session, "the question", [](const OperatorModel& m) {
            EXPECT_NE(m.status.kind, StatusKind::aligned) << m.status.headline;
            return m.confirm;
        });
        test::LandmarkWitness witness(session);
        wait_for(session, "green light again", [&](const OperatorModel& m) {
            witness.look(m);
            return m.status.kind == StatusKind::aligned;
        });
        EXPECT_EQ(witness.said(), "Light 2 is right");
    }
    static inline const std::vector<std::string> kCard{"E. M.", "RIGHT"};
};

TEST_F(ProjectorAway, TheLightComesBackWhenAllIsAsItWas) {
    const test::TemporaryFolder folder;
    const std::filesystem::path file = folder.path() / "session.plrec";
    LitAgain lit;
    {
        DrawingSettings how;
        how.card = kCard;
        SessionRecorder recorder(std::make_unique<RecordingFile>(file),
                                 recording_head(test::example_case().prepared, {}, RecordMode::all, how));
        SessionObservers both;
        both.add(&recorder);
        both.add(&lit);
        EXPECT_NE(come_back({}, &both).status.kind, StatusKind::refused);
    }
    EXPECT_GE(lit.updates, 1);
    EXPECT_EQ(lit.cards, 0) << "the name was taken off the skin when the light was verified";
    EXPECT_EQ(lit.whole_plans, 0) << "what was hidden stays so";
    const ReplayResult replayed = replay_session(file, test::example_case().prepared);
    EXPECT_FALSE(replayed.difference) << replayed.difference->what;
    EXPECT_EQ(replayed.ended, "");
    EXPECT_EQ(replayed.resumptions, 1);
}

TEST_F(ProjectorAway, AProjectorThatWasMovedMeanwhileStaysDark) {
    const OperatorModel model = come_back("projector");
    EXPECT_EQ(model.status.kind, StatusKind::refused);
    EXPECT_NE(model.status.headline.find("the rig has moved"), std::string::npos) << model.status.headline;
}

}  // namespace
}  // namespace planlight
