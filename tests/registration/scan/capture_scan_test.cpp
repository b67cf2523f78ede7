#include <gtest/gtest.h>

#include "planning_io/types/error.h"
#include "registration/scan/scan_surface.h"

namespace planlight {
namespace {

using namespace std::chrono_literals;

struct FakeClock : Clock {
    Instant time{1s};
    Instant now() const override { return time; }
};

/// Light follows 30 ms after show().
struct FakeProjector : Projector {
    FakeClock& clock;
    bool dark = true;
    int shown = 0, fails_at = -1;
    RgbImage on;
    Instant lit_from{}, until{};

    explicit FakeProjector(FakeClock& c) : clock(c) {}
    int width() const override { return 64; }
    int height() const override { return 48; }
    Instant show(const RgbImage& picture, Instant valid_until) override {
        if (shown++ == fails_at) throw DeviceError("projector", "the window is gone", "Restart.");
        dark = false;
        on = picture;
        until = valid_until;
        return lit_from = clock.time + 30ms;
    }
    void go_dark() noexcept override { dark = true; }
};

/// Looks straight into the projector; a frame every 16 ms, open for 8 ms.
struct FakeCameras : StereoCamera {
    FakeClock& clock;
    FakeProjector& projector;
    int grabbed = 0, fails_at = -1, early_at = -1, late_at = -1, empty_at = -1;

    FakeCameras(FakeClock& c, FakeProjector& p) : clock(c), projector(p) {}
    StereoFrame grab(Instant not_before, std::chrono::milliseconds) override {
        const int i = grabbed++;
        if (i == fails_at) throw DeviceError("stereo camera", "no frame", "Plug it in.");
        Instant opened = not_before + 5ms;
        if (i == early_at) opened = not_before - 3ms;
        if (i == late_at) opened = projector.until - 1ms;
        clock.time = opened + 8ms;
        StereoFrame frame;
        frame.at = opened + 4ms;
        frame.exposure = 8ms;
        frame.number = static_cast<std::uint64_t>(i);
        if (i == empty_at) return frame;
        frame.left = frame.right = GrayImage(64, 48);
        for (std::size_t p = 0; p < frame.left.pixels.size(); ++p)
            frame.left.pixels[p] = frame.right.pixels[p] =
                static_cast<std::uint8_t>(projector.on.pixels[p][0] * 4 / 5 + 10);
        return frame;
    }
};

struct CaptureScan : testing::Test {
    FakeClock clock;
    FakeProjector projector{clock};
    FakeCameras cameras{clock, projector};
    StripeSettings stripes;
    CaptureScan() {
        stripes.width = 64;
        stripes.height = 48;
    }
    ScanCapture run() { return capture_scan(projector, cameras, clock, stripes); }
};

TEST_F(CaptureScan, EveryPictureIsSeenInOrderAndTheProjectorIsDarkAfterwards) {
    int calls = 0;
    const ScanCapture capture = capture_scan(projector, cameras, clock, stripes, [&](int done, int of) {
        EXPECT_EQ(done, ++calls);
        EXPECT_EQ(of, static_cast<int>(stripe_sequence(stripes).size()));
        EXPECT_FALSE(projector.dark);
    });
    EXPECT_TRUE(projector.dark);
    EXPECT_EQ(calls, static_cast<int>(stripe_sequence(stripes).size()));
    EXPECT_LT(capture.began, capture.ended);
    const DecodedView view = decode_stripes(capture.left, capture.stripes);
    ASSERT_EQ(view.decoded, 64u * 48u);
    for (std::size_t i = 0; i < view.column.size(); ++i) {
        ASSERT_NEAR(view.column[i], static_cast<double>(i % 64), 0.05);
        ASSERT_NEAR(view.row[i], static_cast<double>(i / 64), 0.05);
    }
}

TEST_F(CaptureScan, DarkAfterADeviceFails) {
    cameras.fails_at = 7;
    EXPECT_THROW(run(), DeviceError);
    EXPECT_TRUE(projector.dark);
}

TEST_F(CaptureScan, DarkAfterTheProjectorFails) {
    projector.fails_at = 7;
    EXPECT_THROW(run(), DeviceError);
    EXPECT_TRUE(projector.dark);
}

TEST_F(CaptureScan, DarkAfterTheCallerThrows) {
    EXPECT_THROW(capture_scan(projector, cameras, clock, stripes,
                              [](int done, int) {
                                  if (done == 3) throw std::runtime_error("cancelled");
                              }),
                 std::runtime_error);
    EXPECT_TRUE(projector.dark);
}

TEST_F(CaptureScan, AFrameThatSawTheLastPictureIsRefused) {
    cameras.early_at = 9;
    EXPECT_THROW(run(), DeviceError);
    EXPECT_TRUE(projector.dark);
}

TEST_F(CaptureScan, AFrameThatOutlivedThePictureIsRefused) {
    cameras.late_at = 9;
    EXPECT_THROW(run(), DeviceError);
}

TEST_F(CaptureScan, AnEmptyFrameIsRefused) {
    cameras.empty_at = 0;
    EXPECT_THROW(run(), DeviceError);
    cameras.empty_at = 5 + cameras.grabbed;
    EXPECT_THROW(run(), DeviceError);
    EXPECT_TRUE(projector.dark);
}

TEST_F(CaptureScan, StripesForAnotherProjectorAreRefusedBeforeAnyLight) {
    stripes.width = 800;
    EXPECT_THROW(run(), std::invalid_argument);
    EXPECT_EQ(projector.shown, 0);
    EXPECT_TRUE(projector.dark);
}

}  // namespace
}  // namespace planlight
