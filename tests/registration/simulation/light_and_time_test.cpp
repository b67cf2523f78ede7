#include <gtest/gtest.h>

#include <chrono>
#include <numeric>

#include "planning_io/types/error.h"
#include "registration/simulation/simulated_rig.h"
#include "tests/registration/simulation/analytic_volume.h"

namespace planlight::simulation {

using std::chrono::milliseconds;

namespace {

const Volume& volume() {
    static const Volume v = test::volume_of_analytic_head();
    return v;
}

RoomSettings paper_room(unsigned seed) {
    RoomSettings settings;
    settings.preset = Preset::paper;
    settings.seed = seed;
    settings.ambient = 0.05;  // a dark room, so that the projector's light stands out
    return settings;
}

RgbImage plain(const Projector& p, std::uint8_t grey) {
    return {p.width(), p.height(), {grey, grey, grey}};
}

double brightness(const GrayImage& picture) {
    return std::accumulate(picture.pixels.begin(), picture.pixels.end(), 0.0) /
           static_cast<double>(picture.pixels.size());
}

class Room : public testing::Test {
protected:
    static SimulatedRig& rig() {
        static SimulatedRig r(volume(), {}, paper_room(7));
        return r;
    }
    static StereoFrame frame(Instant not_before = {}) { return rig().cameras().grab(not_before, milliseconds(5000)); }
    static Instant now() { return rig().clock().now(); }
};

}  // namespace

TEST_F(Room, TimePassesOnlyByWaitingAndGrabbing) {
    const Instant before = now();
    rig().projector().show(plain(rig().projector(), 10), before);
    EXPECT_EQ(now(), before);
    rig().wait(milliseconds(13));
    EXPECT_EQ(now(), before + milliseconds(13));
    const StereoFrame seen = frame(before + milliseconds(300));
    EXPECT_GE(seen.at - seen.exposure / 2, before + milliseconds(300));
    EXPECT_LT(seen.at, before + milliseconds(300 + 40 + 8));
    EXPECT_EQ(now(), seen.at + seen.exposure / 2);
    const StereoFrame next = frame();
    EXPECT_EQ(next.number, seen.number + 1);
    EXPECT_EQ(frame(now() + milliseconds(200)).number, next.number + 6);  // the 5 frames between were not asked for
}

TEST_F(Room, NoFrameWithinThePatienceIsADeviceError) {
    const Instant before = now();
    EXPECT_THROW(rig().cameras().grab(before + milliseconds(500), milliseconds(100)), DeviceError);
    EXPECT_EQ(now(), before + milliseconds(100));
}

TEST_F(Room, LightComesWhenPromisedAndGoesWhenItExpires) {
    rig().projector().go_dark();
    const double dark = brightness(frame(now() + milliseconds(100)).left);
    const Instant asked = now(), until = asked + milliseconds(400);
    const Instant lit = rig().projector().show(plain(rig().projector(), 255), until);
    EXPECT_EQ(lit - asked, milliseconds(25));
    EXPECT_GT(brightness(frame(lit).left), 3 * dark);
    EXPECT_GT(brightness(frame(until - milliseconds(45)).left), 3 * dark);
    EXPECT_NEAR(brightness(frame(until + milliseconds(25)).left), dark, 0.2);
}

TEST_F(Room, BeforeTheDelayTheFormerPictureIsLit) {
    Projector& projector = rig().projector();
    const Instant long_time = now() + std::chrono::seconds(9);
    const double white = brightness(frame(projector.show(plain(projector, 255), long_time)).left);
    const StereoFrame seen = frame();
    // Black ordered 10 ms before an exposure begins is not light on the patient yet.
    const Instant next_begins = seen.at - seen.exposure / 2 + milliseconds(40);
    rig().wait(next_begins - milliseconds(10) - now());
    const Instant on = projector.show(plain(projector, 0), long_time);
    EXPECT_NEAR(brightness(frame().left), white, 0.2);
    EXPECT_LT(brightness(frame(on).left), 0.5 * white);
}

TEST_F(Room, APictureOfAnotherSizeIsRefusedAndDark) {
    Projector& projector = rig().projector();
    frame(projector.show(plain(projector, 255), now() + std::chrono::seconds(9)));
    EXPECT_THROW(projector.show(RgbImage(10, 10), now() + std::chrono::seconds(9)), DeviceError);
    const double after = brightness(frame(now() + milliseconds(30)).right);
    projector.go_dark();
    EXPECT_NEAR(after, brightness(frame(now() + milliseconds(30)).right), 0.2);
}

TEST_F(Room, NoiseIsThatOfLightAndOfReading) {
    Projector& projector = rig().projector();
    const Instant on = projector.show(plain(projector, 255), now() + std::chrono::seconds(20));
    std::vector<GrayImage> pictures{frame(on).left};
    for (int i = 1; i < 12; ++i) pictures.push_back(frame().left);
    const double n = static_cast<double>(pictures.size());
    double bright = 0, black = 0;
    int bright_count = 0, black_count = 0;
    for (std::size_t i = 0; i < pictures[0].pixels.size(); ++i) {
        double sum = 0, square = 0;
        for (const auto& p : pictures) {
            sum += p.pixels[i];
            square += p.pixels[i] * p.pixels[i];
        }
        const double mean = sum / n, variance = (square - sum * mean) / (n - 1);
        if (mean > 140 && mean < 180) {
            bright += variance;
            ++bright_count;
        } else if (mean < 1) {
            black += variance;
            ++black_count;
        }
    }
    ASSERT_GT(bright_count, 1000);
    ASSERT_GT(black_count, 1000);
    // 12000 electrons at full scale: 160 * 255 / 12000 of shot noise, 0.7^2 of reading, 1 / 12 of rounding.
    EXPECT_NEAR(bright / bright_count, 160 * 255 / 12000.0 + 0.49 + 1 / 12.0, 0.35);
    EXPECT_LT(black / black_count, 0.6);
}

TEST(RoomSeed, TheSameSeedIsTheSameRoomToTheBit) {
    SimulatedRig a(volume(), {}, paper_room(9)), b(volume(), {}, paper_room(9)), c(volume(), {}, paper_room(10));
    for (SimulatedRig* rig : {&a, &b, &c})
        rig->wait(rig->projector().show(plain(rig->projector(), 200), std::chrono::seconds(9)));
    const auto seen = [](SimulatedRig& rig) { return rig.cameras().grab({}, milliseconds(1000)); };
    const StereoFrame in_a = seen(a), in_b = seen(b), in_c = seen(c);
    EXPECT_EQ(in_a.left.pixels, in_b.left.pixels);
    EXPECT_EQ(in_a.right.pixels, in_b.right.pixels);
    EXPECT_NE(in_a.left.pixels, in_c.left.pixels);
    EXPECT_EQ(a.truth_json(), b.truth_json());
    EXPECT_GT(angle_between(a.true_rig_from_ct({}), c.true_rig_from_ct({})), 0.05);
}

}  // namespace planlight::simulation
