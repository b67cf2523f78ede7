#include <gtest/gtest.h>

#include "planning_io/types/statistics.h"
#include "tests/app/guided_room.h"

namespace planlight {
namespace {

/// The first places to which the person brings the board: useful, too aslant, useful, before one camera only, useful,
/// as before. Four poses are enough for a rig that is good to a tenth of a millimetre (predicted after four poses:
/// 0.006 to 0.007).
TEST(GuidedCalibration, DISABLED_ASimulatedPersonIsLedToARigAndEveryBadPlaceIsRefusedWithItsReason) {
    PoseGuideSettings settings;
    settings.least_poses = 3;
    settings.most_poses = 4;
    const test::GuidedRoom room = test::guide_in_room(simulation::Preset::paper, 1, settings);
    EXPECT_GE(room.poses, 3U);
    EXPECT_LE(room.poses, 4U);
    ASSERT_FALSE(room.calibration.refusal) << room.calibration.refusal->reason;
    EXPECT_LT(quantile(room.error.points_mm, 0.95), 0.1);
    EXPECT_LT(quantile(room.error.light_mm, 0.95), 0.25);
    EXPECT_TRUE(room.every_reason_said);
    EXPECT_GE(room.refused.count("seen by one camera"), 1U);
    EXPECT_GE(room.refused.count("as a pose that is there"), 1U);
    EXPECT_EQ(room.refused.count("its pictures"), 0U);
}

}  // namespace
}  // namespace planlight
