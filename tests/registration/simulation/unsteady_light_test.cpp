#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <numeric>

#include "registration/simulation/board_room.h"

namespace planlight::simulation {
namespace {

using std::chrono::milliseconds;

BoardRoomSettings paper_room() {
    BoardRoomSettings settings;
    settings.preset = Preset::paper;
    settings.seed = 5;
    settings.poses = 1;
    settings.noise = false;
    return settings;
}

double brightness(const GrayImage& picture) {
    return std::accumulate(picture.pixels.begin(), picture.pixels.end(), 0.0) /
           static_cast<double>(picture.pixels.size());
}

/// Mean brightness of the left picture under one colour, 100 ms after it was ordered.
double seen(SimulatedBoardRoom& room, Rgb colour) {
    Projector& projector = room.projector();
    const Instant now = room.clock().now();
    projector.show(RgbImage(projector.width(), projector.height(), colour), now + std::chrono::seconds(2));
    return brightness(room.cameras().grab(now + milliseconds(100), milliseconds(500)).left);
}

}  // namespace

TEST(UnsteadyLight, AWheelGivesEachColourItsThirdOfATurnAndAllOfThemInWholeTurns) {
    LightSettings light;
    light.wheel_hz = 100;
    const auto red = wheel_during(light, milliseconds(0), milliseconds(3));
    EXPECT_NEAR(red[0], 3, 1e-9);
    EXPECT_NEAR(red[1] + red[2], 0, 1e-9);
    for (const double share : wheel_during(light, milliseconds(7), milliseconds(37))) EXPECT_NEAR(share, 1, 1e-9);
    const auto most =
        wheel_during(light, milliseconds(5), milliseconds(13));  // half of green, all of blue, 3 ms of red
    EXPECT_NEAR(most[0], 3 * (3.0 / 8), 1e-9);
    EXPECT_NEAR(most[1], 3 * (10.0 / 6 / 8), 1e-6);
    EXPECT_NEAR(most[2], 3 * (10.0 / 3 / 8), 1e-6);
}

TEST(UnsteadyLight, LampsAverageOutOverTheirCycle) {
    LightSettings light;
    light.mains_hz = 100;
    light.mains_depth = 0.3;
    EXPECT_NEAR(lamps_during(light, milliseconds(3), milliseconds(23)), 1, 1e-9);
    EXPECT_NEAR(lamps_during(light, Instant(-1000), Instant(1000)), 1.3, 1e-6) << "at its crest";
    EXPECT_NEAR(lamps_during(light, milliseconds(0), milliseconds(5)), 1, 1e-9) << "crest and trough";
}

TEST(UnsteadyLight, APanelHasTheGammaEndsAndColoursItIsGiven) {
    BoardRoomSettings settings = paper_room();
    settings.light.panel.gamma = 1;
    settings.light.panel.dark_end = 51.0 / 255;
    settings.light.panel.colours = {0.25, 0.6, 0.15};
    SimulatedBoardRoom room(white_card(), settings);
    const double black = seen(room, {0, 0, 0}), white = seen(room, {255, 255, 255});
    EXPECT_NEAR(seen(room, {51, 51, 51}), black, 0.01) << "crushed";
    EXPECT_NEAR((seen(room, {153, 153, 153}) - black) / (white - black), 0.5, 0.01) << "straight from there";
    EXPECT_NEAR((seen(room, {0, 255, 0}) - black) / (white - black), 0.6, 0.01);
    room.cover_projector(true);
    EXPECT_LT(seen(room, {255, 255, 255}), black) << "not even the leak";
}

TEST(UnsteadyLight, ByDefaultAFrameSeesItsMiddleAndWithWholeExposureItsShare) {
    for (const bool whole : {false, true}) {
        BoardRoomSettings settings = paper_room();
        settings.light.whole_exposure = whole;
        SimulatedBoardRoom room(white_card(), settings);
        const double black = seen(room, {0, 0, 0}), white = seen(room, {255, 255, 255});
        seen(room, {0, 0, 0});
        Projector& projector = room.projector();
        // Frames every 40 ms from 0 on, 8 ms long; light 2 ms before the end of one.
        const Instant next = (room.clock().now() / milliseconds(40) + 2) * milliseconds(40);
        room.wait(next + milliseconds(6) - milliseconds(25) - room.clock().now());
        projector.show(RgbImage(projector.width(), projector.height(), {255, 255, 255}),
                       next + std::chrono::seconds(2));
        const double share = (brightness(room.cameras().grab(next, milliseconds(500)).left) - black) / (white - black);
        EXPECT_NEAR(share, whole ? 0.25 : 0.0, 0.01);
    }
}

TEST(UnsteadyLight, DelayJitterAndRefreshAreWhatTheTruthSays) {
    BoardRoomSettings settings = paper_room();
    settings.light.untold_delay = milliseconds(10);
    settings.light.jitter = milliseconds(6);
    settings.light.skipped_orders = 0.3;
    SimulatedBoardRoom room(white_card(), settings);
    for (int i = 0; i < 200; ++i) {
        const Instant now = room.clock().now();
        EXPECT_EQ(room.projector().show(RgbImage(800, 600), now + milliseconds(90)) - now, milliseconds(25))
            << "as it promises";
        room.wait(milliseconds(50));
    }
    double mean_s = 0;
    int shown = 0;
    for (const TrueLight& light : room.true_lights()) {
        EXPECT_GE(light.lit - light.asked, milliseconds(35));
        EXPECT_LE(light.lit - light.asked, milliseconds(41));
        mean_s += seconds(light.lit - light.asked) / 200;
        shown += light.shown;
    }
    EXPECT_NEAR(mean_s, 0.038, 0.0005);
    EXPECT_NEAR(shown, 140, 30);
    settings.light.refresh_hz = 60;
    SimulatedBoardRoom refreshed(white_card(), settings);
    refreshed.wait(milliseconds(3));
    refreshed.projector().show(RgbImage(800, 600), std::chrono::seconds(9));
    const double pictures = 60 * seconds(refreshed.true_lights().front().lit);
    EXPECT_NEAR(pictures, std::round(pictures), 1e-4);
}

TEST(UnsteadyLight, LostFramesLeaveAGapInTheNumbers) {
    BoardRoomSettings settings = paper_room();
    settings.light.lost_frames = 0.2;
    SimulatedBoardRoom room(white_card(), settings);
    const auto first = room.cameras().grab({}, milliseconds(500)).number;
    std::uint64_t last = first;
    for (int i = 0; i < 60; ++i) last = room.cameras().grab({}, milliseconds(900)).number;
    EXPECT_NEAR(static_cast<double>(last - first), 60 / 0.8, 12);
}

}  // namespace planlight::simulation
