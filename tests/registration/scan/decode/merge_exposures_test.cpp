#include "registration/scan/decode/merge_exposures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "planning_io/types/error.h"
#include "tests/registration/scan/stripe_room.h"

namespace planlight {
namespace {

using namespace stripe_room;

const Eigen::Vector3d kCentre(120, -40, 360);

/// The sphere's crown saturates, its flanks are right.
Room glaring_room(double white_grey) {
    Room room = paper_room(sphere(kCentre, 80));
    room.light.white_grey = white_grey;
    return room;
}

std::size_t far_off(const std::vector<Eigen::Vector3d>& points) {
    return static_cast<std::size_t>(std::count_if(
        points.begin(), points.end(), [](const auto& p) { return std::abs((p - kCentre).norm() - 80) > 0.5; }));
}

TEST(MergeExposures, ASaturatedPixelTakesTheDarkerOneAndADarkPixelTheBrighter) {
    // 350 grey of light at the crown: over the end of the scale; 30: the steep flanks are lost in the dark.
    const Room bright = glaring_room(350), dim = glaring_room(30);
    const std::vector<ScanCapture> both{capture(bright, stripes_of(bright)), capture(dim, stripes_of(dim))};
    const RigCalibration rig = rig_of(bright);
    ScanSettings alike;
    alike.triangulation.stride = 2;  // or what is decoded more is placed more coarsely
    const ScanResult glare = scan_from_capture(both[0], rig, alike), gloom = scan_from_capture(both[1], rig, alike),
                     merged = scan_from_exposures(both, rig, alike);
    ASSERT_GT(glare.left.saturated, 20000u);
    EXPECT_GT(merged.left.decoded, glare.left.decoded + 20000);
    EXPECT_GE(merged.left.decoded, gloom.left.decoded + 300);
    EXPECT_EQ(merged.left.decoded + merged.left.dark + merged.left.saturated + merged.left.uncertain,
              merged.left.column.size());
    for (std::size_t i = 0; i < merged.left.column.size(); ++i) {
        const float best = std::fmin(glare.left.sigma_px[i], gloom.left.sigma_px[i]);  // fmin passes NaN over
        ASSERT_TRUE(merged.left.sigma_px[i] == best || (std::isnan(best) && std::isnan(merged.left.column[i]))) << i;
    }
    EXPECT_GT(merged.raw.three_view, std::max(glare.raw.three_view, gloom.raw.three_view) + 300);
    // What the glare alone puts off the sphere stays; nothing is added.
    EXPECT_LE(far_off(merged.raw.cloud.points_in_rig),
              far_off(glare.raw.cloud.points_in_rig) + far_off(gloom.raw.cloud.points_in_rig));
}

/// The light of two exposures is one light: where the brighter one is blind it goes on as the darker one saw it, and
/// does not fall to a third there.
TEST(MergeExposures, TheLightGoesOnFromOneToTheOther) {
    DecodedView bright;
    bright.width = 40, bright.height = 20;
    const auto dimness = [](std::size_t i) { return 0.02f * std::exp(0.03f * static_cast<float>(i % 40)); };
    for (std::size_t i = 0; i < 800; ++i) {
        bright.column.push_back(static_cast<float>(i % 40));
        bright.row.push_back(static_cast<float>(i / 40));
        bright.sigma_px.push_back(dimness(i));
    }
    DecodedView dark = bright;
    for (float& sigma : dark.sigma_px) sigma *= 3;
    for (std::size_t i = 0; i < 800; ++i)
        if (i % 40 < 12)
            bright.column[i] = bright.row[i] = bright.sigma_px[i] = std::numeric_limits<float>::quiet_NaN();
    take_better(bright, dark);
    for (std::size_t i = 0; i < 800; ++i) {
        ASSERT_EQ(bright.sigma_px[i], (i % 40 < 12 ? 3 : 1) * dimness(i)) << i;  // the noise is what it is
        ASSERT_NEAR(dimness_of(bright)[i], dimness(i), 1e-6) << i;
    }
}

/// Moist skin: a glint of five times the skin's light, at another place for each camera. The darker captures that the
/// session adds see the code inside it.
TEST(MergeExposures, AGlintIsReadInTheDarkerCapturesAndPutsNothingOffTheSkin) {
    Room room = paper_room(sphere(kCentre, 80));
    room.light.glint_grey = 900;
    std::vector<ScanCapture> captures;
    for (const double brightness : {255.0, 153.0, 92.0}) {  // as add_darker_captures chooses them
        StripeSettings stripes = stripes_of(room);
        stripes.brightness = static_cast<int>(brightness);
        captures.push_back(capture(room, stripes));
        room.light.seed += 17;
    }
    const RigCalibration rig = rig_of(room);
    const ScanResult one = scan_from_capture(captures[0], rig), all = scan_from_exposures(captures, rig);
    // More than a hundredth of the lit pixels is at the end of the scale: the session would go on.
    ASSERT_GT(one.left.saturated, (one.left.decoded + one.left.saturated) / 100);
    EXPECT_LT(all.left.saturated, one.left.saturated / 10);
    EXPECT_LE(far_off(one.clean.kept.points_in_rig), 2u);
    EXPECT_LE(far_off(all.clean.kept.points_in_rig), 2u);
    // Where the glint lies (the normal halfway between lamp and camera) there is skin now.
    const Eigen::Vector3d to_lamp = (room.projector.eye() - kCentre).normalized(),
                          to_eye = (room.left.eye() - kCentre).normalized();
    const Eigen::Vector3d glint = kCentre + 80 * (to_lamp + to_eye).normalized();
    const auto near_glint = [&](const ScanResult& scan) {
        return std::count_if(scan.raw.cloud.points_in_rig.begin(), scan.raw.cloud.points_in_rig.end(),
                             [&](const auto& p) { return (p - glint).norm() < 4; });
    };
    EXPECT_GT(near_glint(all), 60);
}

// Half a millimetre between two exposures of three seconds each is soon done.
TEST(MergeExposures, APatientWhoMovedBetweenThemIsRefused) {
    const Room bright = glaring_room(350);
    for (const Eigen::Vector3d& way :
         {Eigen::Vector3d(0, 0, 0.5), Eigen::Vector3d(2, 0, 0), Eigen::Vector3d(0, -2, 0)}) {
        Room moved = paper_room(sphere(kCentre + way, 80));
        moved.light.white_grey = 60;
        moved.light.seed = 9;
        const std::vector<ScanCapture> both{capture(bright, stripes_of(bright)), capture(moved, stripes_of(moved))};
        try {
            scan_from_exposures(both, rig_of(bright));
            ADD_FAILURE() << "two poses were merged, apart by " << way.transpose();
        } catch (const CheckFailedError& e) {
            EXPECT_NE(std::string(e.what()).find("not of one pose"), std::string::npos) << e.what();
        }
    }
}

// The pillow rests and is most of what is seen.
TEST(MergeExposures, AHeadThatMovedOnAPillowThatRestsIsRefused) {
    const auto room_of = [](const Eigen::Vector3d& way, double white_grey, unsigned seed) {
        Room room = paper_room(nearest_of({sphere(kCentre + way, 80), plane({0, 0, 400}, {0, 0, -1})}));
        room.light.white_grey = white_grey;
        room.light.seed = seed;
        return room;
    };
    const Room bright = room_of({0, 0, 0}, 250, 1);
    const ScanCapture first = capture(bright, stripes_of(bright));
    const auto merged = [&](const Eigen::Vector3d& way) {
        const Room dim = room_of(way, 60, 9);
        return scan_from_exposures(std::vector<ScanCapture>{first, capture(dim, stripes_of(dim))}, rig_of(bright));
    };
    EXPECT_NO_THROW(merged({0, 0, 0}));
    for (const Eigen::Vector3d& way : {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(3, 0, 0)}) try {
            merged(way);
            ADD_FAILURE() << "two poses were merged, apart by " << way.transpose();
        } catch (const CheckFailedError& e) {
            EXPECT_NE(std::string(e.what()).find("% of what both see"), std::string::npos) << e.what();
        }
}

TEST(MergeExposures, TheOrderDoesNotMatterAndOneIsItself) {
    const Room bright = glaring_room(350), dim = glaring_room(60);
    const DecodedView a = decode_stripes(photograph(bright, bright.left, stripes_of(bright), 1), stripes_of(bright)),
                      b = decode_stripes(photograph(dim, dim.left, stripes_of(dim), 2), stripes_of(dim));
    DecodedView ab = a, ba = b, aa = a;
    take_better(ab, b);
    take_better(ba, a);
    take_better(aa, a);
    EXPECT_EQ(ab.decoded, ba.decoded);
    EXPECT_EQ(aa.decoded, a.decoded);
    for (std::size_t i = 0; i < ab.column.size(); ++i)
        ASSERT_TRUE(ab.column[i] == ba.column[i] || (std::isnan(ab.column[i]) && std::isnan(ba.column[i])));
    DecodedView columns = a;
    columns.row.clear();
    EXPECT_THROW(take_better(columns, a), std::invalid_argument);
    EXPECT_THROW(scan_from_exposures({}, rig_of(bright)), std::invalid_argument);
}

using namespace std::chrono_literals;

/// A rig whose cameras look straight into the projector; light is taken as the square of the grey.
struct MirrorRig : Clock, Projector, StereoCamera {
    double gain = 1;
    mutable Instant time{1s};
    RgbImage on;
    int pictures = 0;
    Instant now() const override { return time; }
    int width() const override { return 64; }
    int height() const override { return 48; }
    Instant show(const RgbImage& picture, Instant) override {
        on = picture;
        ++pictures;
        return time += 30ms;
    }
    void go_dark() noexcept override { on = RgbImage(64, 48); }
    StereoFrame grab(Instant not_before, std::chrono::milliseconds) override {
        StereoFrame frame;
        frame.at = time = not_before + 8ms;
        frame.exposure = 4ms;
        frame.left = frame.right = GrayImage(64, 48);
        for (std::size_t p = 0; p < on.pixels.size(); ++p)
            frame.left.pixels[p] = frame.right.pixels[p] =
                static_cast<std::uint8_t>(std::min(255.0, 10 + gain * on.pixels[p][0] * on.pixels[p][0] / 255));
        return frame;
    }
};

TEST(CaptureExposures, ADarkerCaptureFollowsOnlyWhereSkinSaturates) {
    StripeSettings stripes;
    stripes.width = 64;
    stripes.height = 48;
    const int sequence = static_cast<int>(stripe_sequence(stripes).size());
    MirrorRig rig;
    const auto run = [&] {
        std::vector<ScanCapture> captures{capture_scan(rig, rig, rig, stripes)};
        add_darker_captures(rig, rig, rig, captures);
        return captures;
    };
    rig.gain = 0.8;
    EXPECT_EQ(run().size(), 1u);
    EXPECT_EQ(rig.pictures, sequence);
    rig.gain = 2;  // twice the scale at full white, 0.72 of it at 0.6 of the brightness
    const auto captures = run();
    ASSERT_EQ(captures.size(), 2u);
    EXPECT_EQ(captures[1].stripes.brightness, 153);
    DecodedView view = decode_stripes(captures[0].left, captures[0].stripes);
    EXPECT_EQ(view.decoded, 0u);
    take_better(view, decode_stripes(captures[1].left, captures[1].stripes));
    EXPECT_EQ(view.decoded, view.column.size());
    EXPECT_EQ(view.saturated, 0u);
    rig.gain = 1000;  // no end in sight: three captures, not more
    EXPECT_EQ(run().size(), 3u);
}

}  // namespace
}  // namespace planlight
