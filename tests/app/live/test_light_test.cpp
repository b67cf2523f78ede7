#include "app/live/test_light.h"

#include <gtest/gtest.h>

#include "planning_io/types/error.h"
#include "tests/registration/devices/scripted_camera.h"

namespace planlight {
namespace {

using std::chrono::milliseconds;
using test::SetClock;

/// Remembers what it was told.
struct ToldProjector final : Projector {
    int shows = 0, darks = 0;
    bool fails = false;
    Instant valid_until{};
    RgbImage last;
    int width() const override { return 64; }
    int height() const override { return 48; }
    Instant show(const RgbImage& picture, Instant until) override {
        if (fails) throw DeviceError("projector process", "monitor HDMI-2 is no longer connected", "Connect it.");
        ++shows;
        last = picture;
        valid_until = until;
        return {};
    }
    void go_dark() noexcept override { ++darks; }
};

Monitor monitor() {
    Monitor monitor;
    monitor.width = 64;
    monitor.height = 48;
    return monitor;
}

TEST(TestLight, APictureExpiresASecondAfterItWasLastKept) {
    SetClock clock(milliseconds(5000));
    ToldProjector projector;
    TestLight light(projector, monitor(), clock);
    EXPECT_EQ(projector.shows, 0) << "nothing is lit by itself";
    light.show(TestPicture::frame);
    EXPECT_EQ(projector.shows, 1);
    EXPECT_EQ(projector.last.width, 64);
    EXPECT_EQ(projector.valid_until, clock.t + milliseconds(1000));
    for (int i = 0; i < 40; ++i, clock.t += milliseconds(50)) {
        light.keep();
        EXPECT_GT(projector.valid_until, clock.t + milliseconds(500)) << "it never comes near its end while it is kept";
    }
    EXPECT_LT(projector.shows, 8) << "and is not sent again with every look";
}

TEST(TestLight, DarkIsDarkAtOnceAndStaysSo) {
    SetClock clock(milliseconds(5000));
    ToldProjector projector;
    TestLight light(projector, monitor(), clock);
    light.show(TestPicture::star);
    light.show(TestPicture::dark);
    EXPECT_EQ(projector.darks, 1);
    const int shows = projector.shows;
    clock.t += std::chrono::seconds(10);
    light.keep();
    EXPECT_EQ(projector.shows, shows);
}

TEST(TestLight, ALostProjectorIsDarkSaidAndNotLitAgainByItself) {
    SetClock clock(milliseconds(5000));
    ToldProjector projector;
    TestLight light(projector, monitor(), clock);
    light.show(TestPicture::steps);
    projector.fails = true;
    clock.t += milliseconds(500);
    light.keep();
    EXPECT_EQ(light.shown(), TestPicture::dark);
    EXPECT_NE(light.trouble().what.find("no longer connected"), std::string::npos);
    EXPECT_GE(projector.darks, 1);
    projector.fails = false;
    clock.t += milliseconds(500);
    light.keep();
    EXPECT_EQ(projector.shows, 1);
    light.show(TestPicture::steps);
    EXPECT_EQ(projector.shows, 2);
    EXPECT_TRUE(light.trouble().empty());
}

TEST(TestLight, IsDarkAtItsEnd) {
    SetClock clock(milliseconds(5000));
    ToldProjector projector;
    {
        TestLight light(projector, monitor(), clock);
        light.show(TestPicture::name);
    }
    EXPECT_EQ(projector.darks, 1);
}

}  // namespace
}  // namespace planlight
