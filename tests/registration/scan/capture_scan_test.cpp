#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

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

/// By cameras that look straight into the projector.
void expect_every_point_decoded(const ScanCapture& capture) {
    const DecodedView view = decode_stripes(capture.left, capture.stripes);
    ASSERT_EQ(view.decoded, 64u * 48u);
    for (std::size_t i = 0; i < view.column.size(); ++i) {
        ASSERT_NEAR(view.column[i], static_cast<double>(i % 64), 0.05);
        ASSERT_NEAR(view.row[i], static_cast<double>(i / 64), 0.05);
    }
}

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
    expect_every_point_decoded(capture);
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

/// Cameras that expose for 10 ms every 40 ms, whose frames come 50 ms later, and a projector whose picture is light
/// 25 to 40 ms after its order. What a frame sees is the light of its whole exposure.
struct FreeRun : Clock, Projector, StereoCamera {
    static constexpr Instant kStep = 40ms, kExposure = 10ms, kTransfer = 50ms, kSoonest = 25ms, kLatest = 40ms;
    struct Light {
        RgbImage picture;
        Instant from, whole;  ///< the picture before it until `from`, both from there on, it alone from `whole` on
    };
    Instant time{1s};
    std::vector<Light> lights;
    std::vector<int> lost;  ///< exposures after the first picture whose frames never come, by their count
    bool tells = true, dark = true;
    int waited = 0;
    Instant began_at{};

    Instant now() const override { return time; }
    int width() const override { return 64; }
    int height() const override { return 48; }
    Instant show(const RgbImage& picture, Instant) override {
        if (lights.empty()) began_at = time;
        dark = false;
        lights.push_back({picture, time + kSoonest, time + kLatest});
        time += 12ms;  // to the display
        return lights.back().whole;
    }
    void go_dark() noexcept override { dark = true; }

    static Instant first_opening(Instant not_before) {
        return (not_before.count() + kStep.count() - 1) / kStep.count() * kStep;
    }
    bool wait_until_exposed(Instant not_before, std::chrono::milliseconds) override {
        if (!tells) return false;
        ++waited;
        time = std::max(time, first_opening(not_before) + kExposure + 1ms);
        return true;
    }
    StereoFrame grab(Instant not_before, std::chrono::milliseconds) override {
        Instant opened = first_opening(not_before);
        while (std::find(lost.begin(), lost.end(), (opened - first_opening(began_at)) / kStep) != lost.end())
            opened += kStep;
        time = std::max(time, opened + kExposure + kTransfer);
        StereoFrame frame;
        frame.at = opened + kExposure / 2;
        frame.exposure = kExposure;
        frame.left = GrayImage(64, 48);
        constexpr int kParts = 10;
        std::vector<double> sum(frame.left.pixels.size());
        for (int part = 0; part < kParts; ++part) {
            const Instant t = opened + kExposure * part / (kParts - 1);
            for (std::size_t p = 0; p < sum.size(); ++p) {
                double grey = 0;
                for (const Light& light : lights)
                    if (t >= light.whole)
                        grey = light.picture.pixels[p][0];
                    else if (t >= light.from)
                        grey = 0.5 * (grey + light.picture.pixels[p][0]);
                sum[p] += grey / kParts;
            }
        }
        for (std::size_t p = 0; p < sum.size(); ++p)
            frame.left.pixels[p] = static_cast<std::uint8_t>(sum[p] * 0.8 + 10);
        frame.right = frame.left;
        return frame;
    }
    StripeSettings stripes() const {
        StripeSettings settings;
        settings.width = 64;
        settings.height = 48;
        return settings;
    }
    ScanCapture run() { return capture_scan(*this, *this, *this, stripes()); }
};

TEST(CaptureScanInFreeRun, APictureIsOrderedWhileTheFrameOfTheOneBeforeIsOnItsWay) {
    FreeRun ahead, one_by_one;
    one_by_one.tells = false;
    const ScanCapture quick = ahead.run(), slow = one_by_one.run();
    expect_every_point_decoded(quick);
    EXPECT_EQ(quick.left.size(), slow.left.size());
    for (std::size_t i = 0; i < quick.left.size(); ++i) EXPECT_EQ(quick.left[i].pixels, slow.left[i].pixels) << i;
    const double pictures = static_cast<double>(quick.left.size() - 1);
    EXPECT_NEAR(seconds(quick.ended - quick.began) / pictures, 0.080, 1e-6) << "every second exposure";
    EXPECT_GT(seconds(slow.ended - slow.began) / pictures, 0.119);
    EXPECT_TRUE(ahead.dark);
}

TEST(CaptureScanInFreeRun, WhereAFrameIsLostItsPictureIsTakenAgainForTheNextHasSeenAnother) {
    FreeRun room;
    room.lost = {7, 8, 19};
    expect_every_point_decoded(room.run());
    EXPECT_GT(room.lights.size(), stripe_sequence(room.stripes()).size()) << "a picture was shown twice";
}

TEST(CaptureScanInFreeRun, WhereManyFramesAreLostEachPictureWaitsForTheFrameBeforeIt) {
    FreeRun room;
    for (int i = 5; i < 400; i += 3) room.lost.push_back(i);
    expect_every_point_decoded(room.run());
    const std::size_t pictures = stripe_sequence(room.stripes()).size();
    EXPECT_LT(room.waited, static_cast<int>(pictures) - 5);
    EXPECT_LE(room.lights.size(), pictures + 6) << "of three pictures two orders more: its own and that of the next";
}

/// Its times may be wrong by more than the light is said to take.
TEST(CaptureScanInFreeRun, NothingIsOrderedAheadOfAFrameWhereLightIsSaidToComeAtOnce) {
    struct Fast : FreeRun {
        Instant show(const RgbImage& picture, Instant until) override {
            FreeRun::show(picture, until);
            lights.back().from = lights.back().whole = time + 2ms;
            return time + 2ms;
        }
    } room;
    expect_every_point_decoded(room.run());
    EXPECT_EQ(room.waited, 0);
}

}  // namespace
}  // namespace planlight
