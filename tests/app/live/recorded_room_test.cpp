#include "app/live/recorded_room.h"

#include <gtest/gtest.h>

#include "app/live/real_room.h"
#include "planning_io/case/capture_folder.h"
#include "planning_io/case/frames_folder.h"
#include "planning_io/types/error.h"
#include "registration/scan/scan_surface.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

StripeSettings stripes() {
    StripeSettings settings;
    settings.width = 64;
    settings.height = 48;
    return settings;
}

/// A capture whose pictures are grey, each of its own, from 100 on; of the right camera one more.
CaptureFolder capture() {
    CaptureFolder capture;
    capture.projector_width = 64;
    capture.projector_height = 48;
    for (const StripePattern& pattern : stripe_sequence(stripes())) {
        const auto grey = static_cast<std::uint8_t>(100 + capture.names.size());
        capture.names.push_back(pattern.name);
        capture.left.emplace_back(32, 24, grey);
        capture.right.emplace_back(32, 24, static_cast<std::uint8_t>(grey + 1));
    }
    return capture;
}

/// Five frames every 40 ms, from grey 10 on.
std::vector<StereoFrame> frames(int width = 32) {
    std::vector<StereoFrame> frames(5);
    for (std::size_t i = 0; i < frames.size(); ++i) {
        const auto grey = static_cast<std::uint8_t>(10 + i);
        frames[i].left = GrayImage(width, 24, grey);
        frames[i].right = GrayImage(width, 24, static_cast<std::uint8_t>(grey + 50));
        frames[i].at = std::chrono::hours(3) + milliseconds(40) * static_cast<int>(i);
        frames[i].exposure = milliseconds(10);
        frames[i].number = 7 + i + (i > 2 ? 2 : 0);
    }
    return frames;
}

class RecordedRoomTest : public ::testing::Test {
protected:
    const test::TemporaryFolder folder_;
    const fs::path root_ = folder_.path();
    SteadyClock clock_;
    RoomFile room_;
    void SetUp() override {
        write_capture(capture(), root_ / "capture");
        write_frames(frames(), root_ / "frames");
        room_.recorded = RoomRecording{root_ / "frames", root_ / "capture", true};
    }
    std::string refusal() const {
        try {
            read_recorded_room(*room_.recorded);
        } catch (const Error& error) {
            EXPECT_FALSE(error.remedy.empty());
            return error.what();
        }
        return {};
    }
};

TEST_F(RecordedRoomTest, AScanSeesThePicturesOfTheCaptureEachUnderItsPattern) {
    RoomCameras cameras(room_, clock_);
    EXPECT_TRUE(cameras.recorded());
    CommandProjector projector(room_, &cameras);
    const ScanCapture scanned = capture_scan(projector.projector(), cameras.pair(), clock_, stripes());
    ASSERT_EQ(scanned.left.size(), capture().names.size());
    for (std::size_t i = 0; i < scanned.left.size(); ++i) {
        EXPECT_EQ(scanned.left[i].at(5, 5), 100 + static_cast<int>(i));
        EXPECT_EQ(scanned.right[i].at(5, 5), 101 + static_cast<int>(i));
    }
    projector.projector().go_dark();
    const StereoFrame after = cameras.pair().grab(clock_.now(), milliseconds(2000));
    EXPECT_LT(after.left.at(0, 0), 20) << "in the dark the frames go on";
}

TEST_F(RecordedRoomTest, FramesAreSeenInTheirOrderAndWhatTheyLackIsCountedAsLost) {
    room_.recorded->capture.clear();
    RoomCameras cameras(room_, clock_);
    for (int i = 0; i < 7; ++i) {
        const StereoFrame frame = cameras.pair().grab({}, milliseconds(2000));
        EXPECT_EQ(frame.left.at(0, 0), 10 + i % 5);
        EXPECT_EQ(frame.right.at(0, 0), 60 + i % 5);
    }
    EXPECT_EQ(cameras.pair().left().frames().counts().incomplete, 2U);
    EXPECT_EQ(cameras.notes().size(), 2U);
    EXPECT_THROW(CommandProjector(room_, &cameras), DeviceError) << "neither a monitor nor a scan";
}

TEST_F(RecordedRoomTest, WithoutFramesTheCamerasSeeWhatTheySawInTheDark) {
    room_.recorded->frames.clear();
    const RecordedRoom room = read_recorded_room(*room_.recorded);
    ASSERT_EQ(room.frames.size(), 1U);
    EXPECT_EQ(capture().names.at(room.frames[0].picture), "black");
}

TEST_F(RecordedRoomTest, IsNoRealRoomAndMustFitItsRig) {
    RigCalibration rig;
    for (CameraModel* camera : {&rig.left_camera, &rig.right_camera}) camera->width = 32, camera->height = 24;
    rig.projector.width = 64, rig.projector.height = 48;
    rig.serials.left_camera = "1", rig.serials.right_camera = "2";
    RealRoom room(room_, rig, nullptr);
    EXPECT_EQ(room.kind(), RoomKind::recorded) << "nothing there is real, and the window says so";
    EXPECT_EQ(room.projector().width(), 64);
    rig.left_camera.width = 33;
    EXPECT_THROW(RealRoom(room_, rig, nullptr), CheckFailedError);
}

TEST_F(RecordedRoomTest, WhatIsNoRecordingIsRefusedByNameWithARemedy) {
    room_.recorded->frames = root_ / "nowhere";
    EXPECT_NE(refusal().find("nowhere"), std::string::npos);
    room_.recorded->frames = root_ / "capture";
    EXPECT_NE(refusal().find("frames.json"), std::string::npos) << refusal();
    write_frames(frames(40), root_ / "wide");
    room_.recorded->frames = root_ / "wide";
    EXPECT_NE(refusal().find("wide"), std::string::npos) << "another size than the capture's";
    write_frames({}, root_ / "empty");
    room_.recorded->frames = root_ / "empty";
    EXPECT_NE(refusal().find("holds no frame"), std::string::npos);
    room_.recorded->frames.clear();
    fs::remove_all(root_ / "capture" / "right");
    EXPECT_NE(refusal().find("left camera's pictures only"), std::string::npos);
}

}  // namespace
}  // namespace planlight
