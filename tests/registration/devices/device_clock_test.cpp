#include "registration/devices/device_clock.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace planlight {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

/// A camera at 25 frames/s whose clock began at another moment and runs fast; frames arrive 8 ms after the device's
/// time, mostly a little later, now and then much.
struct Source {
    std::mt19937 random{1};
    Instant offset = seconds(1000);
    double drift = 100e-6;
    Instant by_device(Instant t) const {
        return t + offset + Instant(static_cast<Instant::rep>(static_cast<double>(t.count()) * drift));
    }
    Instant late() {
        std::exponential_distribution<double> usual(1 / 0.3e-3), busy(1 / 20e-3);
        const double hiccup = random() % 20 == 0 ? busy(random) : 0;
        return milliseconds(8) + from_seconds(usual(random) + hiccup);
    }
};

TEST(DeviceClock, FindsOffsetAndDriftUnderArrivalsThatAreLate) {
    Source source;
    DeviceClock clock;
    std::vector<double> off;
    for (Instant t = seconds(5); t < seconds(125); t += milliseconds(40)) {
        EXPECT_TRUE(clock.add(source.by_device(t), t + source.late()));
        const Instant error = clock.on_session_clock(source.by_device(t)) - milliseconds(8) - t;
        if (t > seconds(15)) off.push_back(std::abs(planlight::seconds(error)));
    }
    std::sort(off.begin(), off.end());
    EXPECT_LT(off[off.size() * 95 / 100], 0.3e-3);
    EXPECT_LT(off.back(), 0.6e-3);
    EXPECT_NEAR(clock.drift(), -100e-6, 15e-6) << "the device runs fast";
    EXPECT_EQ(clock.jumps(), 0u);
}

TEST(DeviceClock, AClockThatJumpsIsNoticedAndLearntAnew) {
    for (const Instant jump : {Instant(seconds(-3)), Instant(milliseconds(-50)), Instant(milliseconds(-30)),
                               Instant(milliseconds(50)), Instant(seconds(600))}) {
        Source source;
        DeviceClock clock;
        Instant t = seconds(5);
        for (; t < seconds(25); t += milliseconds(40)) clock.add(source.by_device(t), t + source.late());
        source.offset += jump;
        const Instant changed = t;
        for (; t < changed + seconds(4); t += milliseconds(40)) clock.add(source.by_device(t), t + source.late());
        EXPECT_EQ(clock.jumps(), 1u) << planlight::seconds(jump);
        EXPECT_LT(std::abs(planlight::seconds(clock.on_session_clock(source.by_device(t)) - milliseconds(8) - t)), 1e-3)
            << planlight::seconds(jump);
    }
}

TEST(DeviceClock, ABusyComputerIsNoJump) {
    Source source;
    DeviceClock clock;
    Instant t = seconds(5);
    for (; t < seconds(25); t += milliseconds(40)) clock.add(source.by_device(t), t + source.late());
    // For a second everything comes late, by less and less, as when a program starts beside.
    for (int i = 25; i > 0; --i, t += milliseconds(40)) {
        EXPECT_TRUE(clock.add(source.by_device(t), t + milliseconds(30 + 10 * i)));
        EXPECT_LT(std::abs(planlight::seconds(clock.on_session_clock(source.by_device(t)) - milliseconds(8) - t)),
                  0.6e-3)
            << "an old picture is not made new";
    }
    EXPECT_LT(std::abs(planlight::seconds(clock.on_session_clock(source.by_device(t)) - milliseconds(8) - t)), 0.6e-3);
    EXPECT_EQ(clock.jumps(), 0u);
}

TEST(DeviceClock, AClockThatIsSetStumblesAndIsToldAtOnce) {
    for (const Instant jump : {Instant(seconds(600)), Instant(seconds(-3)), Instant(milliseconds(-30))}) {
        Source source;
        DeviceClock clock;
        Instant t = seconds(5);
        for (; t < seconds(15); t += milliseconds(40)) clock.add(source.by_device(t), t + source.late());
        source.offset += jump;
        EXPECT_FALSE(clock.add(source.by_device(t), t + source.late())) << "by the first frame";
        EXPECT_NEAR(planlight::seconds(clock.last_jump()), planlight::seconds(jump), 0.15)
            << "but for how late it came";
    }
}

TEST(DeviceClock, FirstFramesThatComeLateAreNoJump) {
    Source source;
    DeviceClock clock;
    Instant t = seconds(5);
    for (int i = 0; i < 3; ++i, t += milliseconds(40)) clock.add(source.by_device(t), t + milliseconds(90));
    EXPECT_TRUE(clock.add(source.by_device(t), t + milliseconds(8)));
    EXPECT_EQ(clock.jumps(), 0u);
    EXPECT_LT(std::abs(planlight::seconds(clock.on_session_clock(source.by_device(t)) - milliseconds(8) - t)), 1e-3);
}

TEST(DeviceClock, ACameraThatIsBehindIsNoClockThatWasSet) {
    Source source;
    DeviceClock clock;
    Instant t = seconds(5);
    for (; t < seconds(15); t += milliseconds(40)) clock.add(source.by_device(t), t + source.late());
    for (int i = 0; i < 250; ++i, t += milliseconds(40)) {
        EXPECT_TRUE(clock.add(source.by_device(t), t + milliseconds(40) + source.late()));
        if (i < 2) continue;
        EXPECT_GT(clock.behind(), milliseconds(35));
        EXPECT_LT(clock.behind(), milliseconds(80));
        EXPECT_LT(std::abs(planlight::seconds(clock.on_session_clock(source.by_device(t)) - milliseconds(8) - t)), 1e-3)
            << "an old picture is not made new, however long it lasts";
    }
    for (int i = 0; i < 5; ++i, t += milliseconds(40)) clock.add(source.by_device(t), t + milliseconds(8));
    EXPECT_EQ(clock.behind(), Instant{}) << "in time again";
    EXPECT_EQ(clock.jumps(), 0u);
}

TEST(DeviceClock, AClockThatRunsWrongIsToldAndAGoodOneNever) {
    for (const double wrong : {0.01, -0.01}) {
        Source source;
        DeviceClock clock;
        Instant t = seconds(5);
        for (; t < seconds(25); t += milliseconds(40)) {
            clock.add(source.by_device(t), t + source.late());
            EXPECT_EQ(clock.runs_wrong(), 0) << "100 millionths, and frames that come late";
        }
        source.drift = wrong;
        source.offset -= Instant(static_cast<Instant::rep>(static_cast<double>(t.count()) * (wrong - 100e-6)));
        const Instant until = t + seconds(20);
        double told = 0;
        for (; t < until && told == 0; t += milliseconds(40)) {
            clock.add(source.by_device(t), t + source.late());
            told = clock.runs_wrong();
        }
        EXPECT_NEAR(told, wrong, 0.004);
        for (int frame = 0; frame < 100; ++frame, t += milliseconds(40)) {
            if (frame % 7 > 4) continue;  // lost on the way
            clock.add(source.by_device(t), t + source.late());
            EXPECT_NE(clock.runs_wrong(), 0) << "frames that are missing acquit nobody, frame " << frame;
        }
    }
}

TEST(DeviceClock, SaysItsUncertainty) {
    Source source;
    DeviceClock clock;
    clock.add(source.by_device(seconds(5)), seconds(5) + milliseconds(8));
    clock.add(source.by_device(seconds(7)), seconds(7) + milliseconds(30));
    EXPECT_GE(clock.uncertainty(), microseconds(500)) << "two seconds on, an unknown drift may have added up";
}

}  // namespace
}  // namespace planlight
