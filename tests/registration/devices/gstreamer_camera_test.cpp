#include "registration/devices/gstreamer_camera.h"

#include <gtest/gtest.h>

#include <functional>

#include "planning_io/types/error.h"
#include "planning_io/types/steady_clock.h"

// GStreamer's own test source, live, in place of a camera.
namespace planlight {
namespace {

using std::chrono::milliseconds;

TEST(GstreamerCamera, PicturesComeGreyWithTheirTimes) {
    FrameBell bell;
    const SteadyClock clock;
    GstreamerSettings settings;
    settings.pipeline =
        "videotestsrc is-live=true pattern=white ! video/x-raw,format=RGB,width=90,height=50,framerate=50/1";
    GstreamerCamera camera(settings, bell, clock);
    EXPECT_EQ(camera.width(), 90);
    EXPECT_EQ(camera.height(), 50);
    std::vector<CameraFrame> frames;
    const Instant until = clock.now() + milliseconds(20000);
    while (frames.size() < 20 && clock.now() < until) {
        for (CameraFrame& frame : camera.frames().take_all()) {
            EXPECT_LT(clock.now() - frame.at, milliseconds(1000));
            frames.push_back(std::move(frame));
        }
        std::this_thread::sleep_for(milliseconds(2));
    }
    ASSERT_GE(frames.size(), 20u);
    EXPECT_GT(frames.back().picture.at(45, 25), 230);
    EXPECT_GT(frames.back().picture.at(89, 49), 230) << "rows of 90 pixels are padded by GStreamer";
    for (std::size_t i = 1; i < frames.size(); ++i) EXPECT_GT(frames[i].at, frames[i - 1].at);
}

TEST(GstreamerCamera, APictureThatIsSentAgainIsNoFrame) {
    FrameBell bell;
    const SteadyClock clock;
    GstreamerSettings settings;
    settings.pipeline =
        "videotestsrc is-live=true pattern=snow ! video/x-raw,framerate=10/1,width=64,height=48 ! "
        "videorate ! video/x-raw,framerate=50/1";
    settings.silence_allowed = milliseconds(20000);  // a busy machine is no fault here
    GstreamerCamera camera(settings, bell, clock);
    // GStreamer's sink drops what waits too long, so how many of the five come is the machine's affair; that none of
    // them is handed out twice is ours.
    std::vector<CameraFrame> frames;
    const Instant until = clock.now() + milliseconds(20000);
    while ((camera.frames().counts().repeated < 20 || frames.size() < 5) && clock.now() < until) {
        for (CameraFrame& frame : camera.frames().take_all()) frames.push_back(std::move(frame));
        std::this_thread::sleep_for(milliseconds(5));
    }
    EXPECT_GE(camera.frames().counts().repeated, 20u);
    ASSERT_GE(frames.size(), 5u) << "new ones come in between";
    for (std::size_t i = 1; i < frames.size(); ++i)
        EXPECT_NE(frames[i].picture.pixels, frames[i - 1].picture.pixels) << "frame " << i;
    EXPECT_FALSE(camera.frames().fault());
}

TEST(GstreamerCamera, APictureThatIsSentAgainAndAgainIsAFault) {
    FrameBell bell;
    const SteadyClock clock;
    GstreamerSettings settings;
    settings.pipeline = "videotestsrc is-live=true pattern=checkers-8";
    GstreamerCamera camera(settings, bell, clock);
    const Instant until = clock.now() + milliseconds(20000);
    while (!camera.frames().fault() && clock.now() < until) std::this_thread::sleep_for(milliseconds(5));
    ASSERT_TRUE(camera.frames().fault());
    EXPECT_NE(camera.frames().fault()->problem.find("one picture again and again"), std::string::npos)
        << camera.frames().fault()->problem;
    EXPECT_EQ(camera.frames().counts().received, 1u);
}

// A UVC camera that needs a second to its first picture, after its cable was pulled: it ends, and is opened again.
TEST(GstreamerCamera, OneThatIsSlowToBeginComesBackAfterAFault) {
    FrameBell bell;
    const SteadyClock clock;
    GstreamerSettings settings;
    settings.pipeline =
        "videotestsrc is-live=true pattern=snow num-buffers=60 ! video/x-raw,width=64,height=48,framerate=50/1 ! "
        "queue min-threshold-time=800000000";
    GstreamerCamera camera(settings, bell, clock);
    const Instant until = clock.now() + std::chrono::seconds(60);
    while (!camera.frames().fault() && clock.now() < until) std::this_thread::sleep_for(milliseconds(5));
    ASSERT_TRUE(camera.frames().fault());
    const std::size_t before = camera.frames().counts().received;
    while (camera.frames().counts().received <= before && clock.now() < until)
        std::this_thread::sleep_for(milliseconds(5));
    EXPECT_GT(camera.frames().counts().received, before);
}

TEST(GstreamerCamera, APipelineThatIsNoneOrEndsIsSaid) {
    FrameBell bell;
    const SteadyClock clock;
    const auto refusal = [&](const std::string& pipeline) {
        GstreamerSettings settings;
        settings.name = "left camera";
        settings.pipeline = pipeline;
        try {
            GstreamerCamera(settings, bell, clock);
        } catch (const DeviceError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_NE(refusal("nosuchsource").find("left camera: \"nosuchsource\" is no pipeline"), std::string::npos);
    EXPECT_NE(refusal("filesrc location=/nowhere").find("sends no frame"), std::string::npos);
    GstreamerSettings settings;
    settings.pipeline = "videotestsrc is-live=true num-buffers=5";
    GstreamerCamera camera(settings, bell, clock);
    const Instant until = clock.now() + milliseconds(10000);
    while (!camera.frames().fault() && clock.now() < until) std::this_thread::sleep_for(milliseconds(5));
    EXPECT_TRUE(camera.frames().fault()) << "a source that ended";
}

}  // namespace
}  // namespace planlight
