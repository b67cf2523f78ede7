#include "registration/tracking/exchanged_cameras.h"

#include <gtest/gtest.h>

#include <utility>

#include "marker_scene.h"

namespace planlight::test {
namespace {

struct Rooms {
    RigCalibration rig = paper_rig();
    std::mt19937 random{7};
    PatientTracker tracker{rig};
    StereoFrame see(const std::vector<Sticker>& stickers, Instant at) {
        return render_frame(rig, stickers, {}, at, random);
    }
    std::vector<Sticker> stickers(const RigidTransform& rig_from_patient) {
        return moved(rig_from_patient * RigidTransform(Eigen::Translation3d(head_centre())), stickers_on_head());
    }
    Rooms() { tracker.set_reference(see(stickers(RigidTransform::Identity()), {})); }
};

TEST(ExchangedCameras, AreToldWhereTheMarkersAreThereTheOtherWayRound) {
    Rooms room;
    for (const double turn_deg : {0.0, 3.0}) {
        StereoFrame frame =
            room.see(room.stickers(head_move({turn_deg, 0, 1}, {2, 0, 0})), std::chrono::milliseconds(40));
        EXPECT_FALSE(cameras_seem_exchanged(room.tracker, frame)) << "they stand as they were calibrated";
        std::swap(frame.left, frame.right);
        EXPECT_TRUE(cameras_seem_exchanged(room.tracker, frame));
    }
}

TEST(ExchangedCameras, APatientWhoIsCoveredOrGoneIsNoExchange) {
    Rooms room;
    std::vector<Sticker> stickers = room.stickers(RigidTransform::Identity());
    for (Sticker& sticker : stickers) sticker.covered = true;
    EXPECT_FALSE(cameras_seem_exchanged(room.tracker, room.see(stickers, std::chrono::milliseconds(40))));
    EXPECT_FALSE(cameras_seem_exchanged(room.tracker, room.see({}, std::chrono::milliseconds(80))));
}

}  // namespace
}  // namespace planlight::test
