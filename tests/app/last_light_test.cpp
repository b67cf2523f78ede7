// Light that was put out and is still on the skin, because the projector holds its picture.
#include <gtest/gtest.h>

#include <functional>

#include "app/session.h"
#include "planning_io/types/error.h"
#include "tests/app/played_session.h"

namespace planlight {
namespace {

using namespace std::chrono_literals;

/// A session in the simulated room whose plan is on the skin.
class LastLight : public testing::TestWithParam<unsigned> {
protected:
    void SetUp() override {
        if (!test::example_case().there) GTEST_SKIP() << "invesalius-examples is not installed";
        settings.preset = simulation::Preset::paper;
        settings.seed = GetParam();
    }
    void start() {
        session.reset();
        room.emplace(test::example_case().volume, std::vector<Eigen::Vector3d>{}, settings);
        drawing.emplace(test::example_case().prepared);
        session.emplace(test::example_case().prepared, *drawing, room->calibration(), room->projector(),
                        room->cameras(), room->clock());
        session->scan();
        session->find_patient();
        session->confirm();
    }
    void follow(int updates) {
        for (int i = 0; i < updates; ++i) ASSERT_TRUE(session->update().overlay.lit);
    }
    /// Of the plan's first point.
    double moved_mm(const RigidTransform& since) const {
        const Eigen::Vector3d p = test::example_case().prepared.plan.osteotomy_lines.front().points_in_ct.front();
        return (room->true_rig_from_ct(room->clock().now()) * p - since * p).norm();
    }
    /// Of frames a fifth of a second apart, in which nothing is followed.
    int looks_that_see_it(int looks) {
        int saw = 0;
        for (int i = 0; i < looks; ++i) {
            room->wait(200ms);
            saw += session->light_stays(room->cameras().newest(room->clock().now(), 1s)) ? 1 : 0;
        }
        return saw;
    }

    int updates_that_see_it(int updates) {
        int saw = 0;
        for (int i = 0; i < updates; ++i) saw += session->update().light_stays ? 1 : 0;
        return saw;
    }

    simulation::RoomSettings settings;
    std::optional<simulation::SimulatedRig> room;
    std::optional<CaseDrawing> drawing;
    std::optional<Session> session;
};

TEST_P(LastLight, IsSeenWhereTheProjectorHoldsItsPictureAndNowhereElse) {
    start();
    follow(8);
    session->go_dark();
    EXPECT_EQ(looks_that_see_it(30), 0) << "it went out";
    follow(8);
    room->freeze_projector();
    session->go_dark();
    EXPECT_GE(looks_that_see_it(6), 1) << "half a second until it should be dark, then two looks";
    EXPECT_EQ(looks_that_see_it(6), 6);
    room->cover_projector(true);
    looks_that_see_it(2);
    EXPECT_EQ(looks_that_see_it(4), 0) << "its lens was covered";
}

TEST_P(LastLight, IsSeenOnAHeadThatMovesAwayUnderIt) {
    start();
    follow(8);
    room->freeze_projector();
    session->go_dark();
    const RigidTransform before = room->true_rig_from_ct(room->clock().now());
    room->set_motion({15, room->clock().now()});
    looks_that_see_it(6);
    double most_mm = 0;
    for (int i = 0; i < 8; ++i) {
        EXPECT_EQ(looks_that_see_it(1), 1);
        most_mm = std::max(most_mm, moved_mm(before));
    }
    EXPECT_GT(most_mm, 4) << "farther than strokes are looked for to their sides";
}

/// Pictures are ordered on for the head where it goes, and none of them reaches the skin: what stays is an older one.
TEST_P(LastLight, IsSeenWhereTheHeadWentOnBeforeItWasPutOut) {
    start();
    room->set_motion({15, room->clock().now()});
    follow(8);
    room->freeze_projector();
    const RigidTransform frozen = room->true_rig_from_ct(room->clock().now());
    for (int i = 0; i < 40 && moved_mm(frozen) < 5; ++i) session->update();
    ASSERT_GT(moved_mm(frozen), 4.5) << "farther than strokes are looked for to their sides";
    session->go_dark();
    looks_that_see_it(5);
    EXPECT_EQ(looks_that_see_it(4), 4);
    room->cover_projector(true);
    looks_that_see_it(2);
    EXPECT_EQ(looks_that_see_it(2), 0) << "its lens was covered";
}

/// Register, pressed once more on the same scan, changes nothing of what the projector holds.
TEST_P(LastLight, IsSeenThroughAnotherMatch) {
    start();
    follow(8);
    session->go_dark();
    session->find_patient();
    EXPECT_EQ(looks_that_see_it(12), 0) << "it went out";
    session->confirm();
    follow(8);
    room->freeze_projector();
    session->go_dark();
    session->find_patient();
    looks_that_see_it(6);
    EXPECT_EQ(looks_that_see_it(6), 6);
}

TEST_P(LastLight, GoesOutForOtherLightToo) {
    start();
    follow(8);
    session->light_landmark(0);
    EXPECT_EQ(updates_that_see_it(60), 0) << "the plan went out, and a ring is lit";
    session->light_landmark(std::nullopt);
    EXPECT_EQ(updates_that_see_it(60), 0);
    session->hide_item(0);
    EXPECT_EQ(updates_that_see_it(60), 0);
    session->light_item(1);
    EXPECT_EQ(updates_that_see_it(60), 0) << "the others are dim";
    session->show_item(std::nullopt);
    EXPECT_EQ(updates_that_see_it(60), 0);
    session->scan();
    EXPECT_EQ(looks_that_see_it(8), 0);
}

TEST_P(LastLight, GoesOutForOtherLightOnAHeadThatMoves) {
    start();
    room->set_motion({15, room->clock().now()});
    follow(8);
    session->light_landmark(0);  // each frame of a moving head is a second's work: as few as tell
    EXPECT_EQ(updates_that_see_it(32), 0);
    session->light_landmark(std::nullopt);
    session->hide_item(0);
    EXPECT_EQ(updates_that_see_it(32), 0);
}

/// What was ordered since never reached the skin: what is there is what was lit before.
TEST_P(LastLight, IsNotThatOfAnOrderThatNeverReachedTheSkin) {
    const std::vector<std::function<void()>> orders{[&] { session->light_landmark(0); }, [&] { session->hide_item(0); },
                                                    [&] { session->light_item(1); }};
    for (std::size_t i = 0; i < orders.size(); ++i) {
        start();
        follow(8);
        room->freeze_projector();
        orders[i]();
        EXPECT_GT(updates_that_see_it(60), 20) << i << ": beside what is ordered";
        session->go_dark();
        looks_that_see_it(6);
        EXPECT_EQ(looks_that_see_it(4), 4) << i;
    }
}

/// Stripes that never reached the skin take nothing's place.
TEST_P(LastLight, IsSeenAfterStripesThatNobodySaw) {
    start();
    follow(8);
    room->freeze_projector();
    session->check_skin();
    looks_that_see_it(4);
    EXPECT_EQ(looks_that_see_it(4), 4) << "after a check of the skin";
    EXPECT_THROW(session->scan(), CheckFailedError);
    looks_that_see_it(4);
    EXPECT_EQ(looks_that_see_it(4), 4) << "after a scan";
}

/// Somebody drew over the lines in white: half as bright as the light, and there when it has gone.
TEST_P(LastLight, IsBrighterThanInkAlongItsLines) {
    start();
    Session::Update lit;
    for (int i = 0; i < 12; ++i) {
        const Session::Update update = session->update();
        if (update.light) lit = update;
    }
    ASSERT_TRUE(lit.light);
    const double seen_grey = light_grey(*lit.light);
    const RigidTransform rig_from_ct = *lit.pose.rig_from_patient * session->registration()->patient_from_ct;
    const auto looks_lit = [&](double grey_when_lit) {
        DarknessCheck check({session->lit_drawing(), rig_from_ct, grey_when_lit}, drawing->skin, session->rig());
        check.look(lit.frame);
        return check.look(lit.frame);
    };
    EXPECT_TRUE(looks_lit(seen_grey));
    EXPECT_TRUE(looks_lit(0)) << "nobody looked at it while it was lit";
    EXPECT_FALSE(looks_lit(2 * seen_grey));
}

TEST_P(LastLight, IsToldByUpdatesThatAreDark) {
    start();
    follow(8);
    room->freeze_projector();
    std::vector<int> markers;
    for (int i = 0; i < 8; ++i) markers.push_back(i);
    room->cover_markers(markers);
    int told = 0, dark = 0;
    for (int i = 0; i < 60; ++i) {
        const Session::Update update = session->update();
        dark += update.overlay.lit ? 0 : 1;
        told += update.light_stays ? 1 : 0;
    }
    EXPECT_GT(dark, 55);
    EXPECT_GT(told, 20) << "of 2.4 seconds, at rest";
    room->cover_markers({});
    EXPECT_TRUE(session->update().overlay.lit);
}

/// A scan shows what is to be done about it.
TEST_P(LastLight, OfAFrozenProjectorScansNothing) {
    start();
    follow(2);
    room->freeze_projector();
    try {
        session->scan();
        ADD_FAILURE() << "its stripes were never lit";
    } catch (const CheckFailedError& refusal) {
        EXPECT_EQ(refusal.what(), std::string("the cameras see none of the stripes on the skin"));
        EXPECT_NE(refusal.remedy.find("not frozen"), std::string::npos) << refusal.remedy;
    }
    EXPECT_EQ(session->scanned(), nullptr);
}

/// What shines, hangs over the skin or has lines of its own is not taken for light that stays.
TEST_P(LastLight, GoesOutInStrangeRoomsToo) {
    settings.wet = 0.7;
    settings.ambient = 0.35;
    settings.things.hair = settings.things.drape_behind = true;
    start();
    follow(8);
    session->go_dark();
    room->set_motion({15, room->clock().now()});
    EXPECT_EQ(looks_that_see_it(16), 0);
}

INSTANTIATE_TEST_SUITE_P(Rooms, LastLight, testing::Values(2));

}  // namespace
}  // namespace planlight
