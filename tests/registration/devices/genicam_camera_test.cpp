#include "registration/devices/genicam_camera.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "planning_io/types/error.h"
#include "planning_io/types/steady_clock.h"
#include "registration/simulation/serve/served_camera.h"
#include "tests/registration/devices/one_served_camera.h"

// Over the loopback network, by the same library calls as a camera on a cable.
namespace planlight {
namespace {

using simulation::ServedCamera;
using simulation::ServedCameraSettings;
using std::chrono::milliseconds;
using test::OneAtATime;
using test::small_camera;

/// Offers a picture every 20 ms whose grey counts up, as long as it lives.
class Source {
public:
    explicit Source(ServedCamera& camera)
        : thread_([this, &camera](const std::stop_token& stop) {
              while (!stop.stop_requested()) {
                  camera.offer(GrayImage(64, 48, ++grey_), clock_.now() - milliseconds(8));
                  std::this_thread::sleep_for(milliseconds(20));
              }
          }) {}

private:
    SteadyClock clock_;
    std::atomic<std::uint8_t> grey_{0};
    std::jthread thread_;
};

bool within(milliseconds patience, const std::function<bool()>& wanted) {
    const auto until = std::chrono::steady_clock::now() + patience;
    while (std::chrono::steady_clock::now() < until) {
        if (wanted()) return true;
        std::this_thread::sleep_for(milliseconds(5));
    }
    return wanted();
}

TEST(GenicamCamera, ACameraThatIsNotThereIsSaid) {
    const OneAtATime turn;
    FrameBell bell;
    const SteadyClock clock;
    GenicamSettings settings;
    settings.name = "left camera";
    settings.device = "NO-SUCH-SERIAL";
    try {
        GenicamCamera(settings, bell, clock);
        FAIL() << "opened a camera that is not there";
    } catch (const DeviceError& error) {
        EXPECT_NE(std::string(error.what()).find("left camera: \"NO-SUCH-SERIAL\" does not answer"), std::string::npos)
            << error.what();
    }
}

TEST(GenicamCamera, WhatItDoesNotTakeIsAnsweredWithWhatItTakes) {
    const OneAtATime turn;
    ServedCamera camera(small_camera());
    const auto remedy = [](GenicamSettings settings) -> std::string {
        settings.device = "T-17";
        FrameBell bell;
        const SteadyClock clock;
        try {
            GenicamCamera(std::move(settings), bell, clock);
        } catch (const DeviceError& error) {
            return error.remedy;
        }
        return "taken";
    };
    GenicamSettings format, line;
    format.pixel_format = "Packed9";
    line.line = "Line9";
    EXPECT_NE(remedy(format).find("a grey one of these: "), std::string::npos) << remedy(format);
    EXPECT_NE(remedy(format).find("Mono8"), std::string::npos) << remedy(format);
    EXPECT_NE(remedy(line).find("\"line\""), std::string::npos) << remedy(line);
}

TEST(GenicamCamera, PicturesComeWithTheTimeOfTheirExposure) {
    const OneAtATime turn;
    ServedCameraSettings served = small_camera();
    served.clock_offset = std::chrono::hours(30);
    served.clock_drift = 100e-6;
    ServedCamera camera(served);
    const Source source(camera);
    FrameBell bell;
    const SteadyClock clock;
    GenicamSettings settings;
    settings.device = "T-17";
    settings.transfer_ms = 0;  // no wire between
    GenicamCamera opened(settings, bell, clock);
    EXPECT_EQ(opened.serial(), "T-17");
    EXPECT_EQ(opened.width(), 64);
    std::vector<CameraFrame> frames;
    ASSERT_TRUE(within(milliseconds(20000), [&] {
        for (CameraFrame& frame : opened.frames().take_all()) {
            EXPECT_LT(clock.now() - frame.at, milliseconds(1000));
            frames.push_back(std::move(frame));
        }
        return frames.size() >= 40;
    }));
    for (std::size_t i = 1; i < frames.size(); ++i) {
        EXPECT_GT(frames[i].at, frames[i - 1].at);
        EXPECT_NE(frames[i].picture.at(5, 5), frames[i - 1].picture.at(5, 5)) << "no exposure comes twice";
        EXPECT_EQ(frames[i].exposure, milliseconds(8));
    }
}

/// A served camera and its frames.
class OpenedCamera : public testing::Test {
protected:
    void SetUp() override { ASSERT_TRUE(sends()); }
    bool sends() {
        return within(milliseconds(20000),
                      [&] { return !opened.frames().fault() && !opened.frames().take_all().empty(); });
    }
    bool fails() {
        return within(milliseconds(8000), [&] { return opened.frames().fault().has_value(); });
    }

    const OneAtATime turn;
    ServedCamera camera{small_camera()};
    const Source source{camera};
    FrameBell bell;
    const SteadyClock clock;
    GenicamCamera opened{[] {
                             GenicamSettings settings;
                             settings.device = "T-17";
                             return settings;
                         }(),
                         bell, clock};
};

TEST_F(OpenedCamera, ThatFallsSilentIsAFaultAndComesBackByItself) {
    camera.silence(true);
    ASSERT_TRUE(fails());
    EXPECT_NE(opened.frames().fault()->problem.find("nothing came from it"), std::string::npos);
    camera.silence(false);
    EXPECT_TRUE(sends());
    EXPECT_EQ(opened.frames().counts().lost_connections, 1u);
}

// It is not waited for by asking it for its exposure, which takes seconds to fail.
TEST_F(OpenedCamera, ThatLosesItsPowerIsAFaultSoon) {
    int soon = 0;
    for (int time = 0; time < 6 && soon < 2; ++time) {  // a question may be on its way when the power goes
        ASSERT_TRUE(sends());
        camera.power(false);
        const Instant off = clock.now();
        ASSERT_TRUE(fails());
        soon += clock.now() - off < milliseconds(1500);  // asked for its exposure it was 2.7 s
        camera.power(true);
    }
    EXPECT_GE(soon, 2);
}

TEST(GenicamCamera, ACameraThatSendsOnePictureUnderNewTimesIsAFault) {
    const OneAtATime turn;
    ServedCamera camera(small_camera());
    FrameBell bell;
    const SteadyClock clock;
    std::atomic<bool> hangs = false;
    const std::jthread source([&](const std::stop_token& stop) {
        GrayImage picture(64, 48);
        for (int y = 0; y < 48; ++y)
            for (int x = 0; x < 64; ++x) picture.at(x, y) = static_cast<std::uint8_t>(3 * x + y);
        while (!stop.stop_requested()) {
            if (!hangs) ++picture.at(20, 16);
            camera.offer(picture, clock.now() - milliseconds(8));
            std::this_thread::sleep_for(milliseconds(20));
        }
    });
    GenicamSettings settings;
    settings.device = "T-17";
    GenicamCamera opened(settings, bell, clock);
    ASSERT_TRUE(within(milliseconds(10000), [&] { return !opened.frames().take_all().empty(); }));
    hangs = true;
    ASSERT_TRUE(within(milliseconds(5000), [&] { return opened.frames().fault().has_value(); }));
    EXPECT_NE(opened.frames().fault()->problem.find("one picture again and again"), std::string::npos)
        << opened.frames().fault()->problem;
    EXPECT_TRUE(opened.frames().take_all().empty());
    hangs = false;
    EXPECT_TRUE(
        within(milliseconds(20000), [&] { return !opened.frames().fault() && !opened.frames().take_all().empty(); }));
}

/// By `wanted` ms of exposure as they are told, or by what the camera had when it was opened.
void change_exposure_of_a_camera(std::optional<double> wanted_ms) {
    const OneAtATime turn;
    ServedCamera camera(small_camera());
    const Source source(camera);
    FrameBell bell;
    const SteadyClock clock;
    GenicamSettings settings;
    settings.device = "T-17";
    settings.exposure_ms = wanted_ms;
    GenicamCamera opened(settings, bell, clock);
    ASSERT_TRUE(within(milliseconds(10000), [&] { return !opened.frames().take_all().empty(); }));
    camera.change_exposure(milliseconds(4));
    std::string problem;
    ASSERT_TRUE(within(milliseconds(10000), [&] {
        const auto fault = opened.frames().fault();
        if (fault) problem = fault->problem;
        return fault.has_value();
    }));
    EXPECT_NE(problem.find("its exposure was changed from 8.00 to 4.00 ms"), std::string::npos) << problem;
    std::vector<CameraFrame> frames;
    ASSERT_TRUE(within(milliseconds(20000), [&] {
        frames = opened.frames().take_all();
        return !opened.frames().fault() && !frames.empty();
    }));
    EXPECT_EQ(frames.back().exposure, milliseconds(8)) << "it is set again";
}

TEST(GenicamCamera, AnExposureThatSomebodyElseChangedIsAFaultAndSetAgain) {
    change_exposure_of_a_camera(8);
    change_exposure_of_a_camera(std::nullopt);
}

}  // namespace
}  // namespace planlight
