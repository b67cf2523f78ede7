#include "registration/tracking/why_lost.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "marker_scene.h"

namespace planlight::test {
namespace {

using Cause = WhyLost::Cause;

struct Lost {
    RigCalibration rig = paper_rig();
    std::mt19937 random{7};
    PatientTracker tracker{rig};
    Lost() { tracker.set_reference(see(rig)); }
    StereoFrame see(const RigCalibration& by, const Look& look = {}, std::vector<Sticker> stickers = on_head()) {
        return render_frame(by, stickers, look, std::chrono::milliseconds(40), random);
    }
    static std::vector<Sticker> on_head() {
        return moved(RigidTransform(Eigen::Translation3d(head_centre())), stickers_on_head());
    }
    WhyLost why(const StereoFrame& frame) {
        PatientTracker other = tracker;
        EXPECT_FALSE(other.update(frame).rig_from_patient) << "it is lost";
        return why_lost(tracker, frame);
    }
};

TEST(WhyLost, PicturesThatAreExchangedTurnedOrMirroredAreCalledSo) {
    Lost lost;
    const StereoFrame seen = lost.see(lost.rig);
    StereoFrame frame = seen;
    std::swap(frame.left, frame.right);
    EXPECT_EQ(lost.why(frame).cause, Cause::exchanged);
    frame = seen;
    for (GrayImage* picture : {&frame.left, &frame.right}) std::ranges::reverse(picture->pixels);
    EXPECT_EQ(lost.why(frame).cause, Cause::turned);
    frame = seen;
    for (GrayImage* picture : {&frame.left, &frame.right})
        for (int y = 0; y < picture->height; ++y)
            std::reverse(picture->pixels.begin() + y * picture->width,
                         picture->pixels.begin() + (y + 1) * picture->width);
    EXPECT_EQ(lost.why(frame).cause, Cause::mirrored);
}

TEST(WhyLost, ACameraThatWasKnockedIsToldFromPicturesThatShowLess) {
    Lost lost;
    RigCalibration knocked = lost.rig;
    knocked.left_camera.device_from_rig =
        Eigen::AngleAxisd(0.4 * M_PI / 180, Eigen::Vector3d::UnitX()) * knocked.left_camera.device_from_rig;
    const WhyLost moved = lost.why(lost.see(knocked));
    EXPECT_EQ(moved.cause, Cause::camera_moved);
    EXPECT_GE(std::min(moved.left, moved.right), lost.tracker.markers().size());
    Look blurred;
    blurred.blur_px = 9;
    EXPECT_EQ(lost.why(lost.see(lost.rig, blurred)).cause, Cause::fewer_seen);
    Look dark;
    dark.light = 0.04;
    EXPECT_EQ(lost.why(lost.see(lost.rig, dark)).cause, Cause::fewer_seen);
}

TEST(WhyLost, MarkersThatWerePastedAnewAreNoCameraThatMoved) {
    Lost lost;
    std::vector<Sticker> anew = Lost::on_head();
    for (std::size_t i = 0; i < anew.size(); ++i) anew[i].centre.y() += i % 2 == 0 ? 9 : -9;
    EXPECT_EQ(lost.why(lost.see(lost.rig, {}, anew)).cause, Cause::rearranged);
}

}  // namespace
}  // namespace planlight::test
