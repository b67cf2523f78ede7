#include "planning_io/types/suspend_watch.h"

#include <gtest/gtest.h>

namespace planlight {
namespace {

using namespace std::chrono_literals;

TEST(SuspendWatch, TellsEachSleepOnceAndNoSlowMachine) {
    SuspendWatch watch;
    EXPECT_FALSE(watch.look(1s, 1000s, 1s)) << "it slept before anybody looked";
    EXPECT_FALSE(watch.look(2s, 1001s, 2s));
    EXPECT_TRUE(watch.look(3s, 4602s, 3s)) << "an hour";
    EXPECT_FALSE(watch.look(4s, 4603s, 4s));
    // The process may wait for a core anywhere between the three, for seconds.
    EXPECT_FALSE(watch.look(5s, 4610s, 11s));
    EXPECT_FALSE(watch.look(12s, 4611s, 14s));
    EXPECT_FALSE(watch.look(15s, 4614s, 15s));
    EXPECT_TRUE(watch.look(16s, 4616s, 16s)) << "one second more than it was awake";
}

TEST(SuspendWatch, OfTheMachineThatRunsTheTestsNothingIsTold) {
    SuspendWatch watch;
    for (int i = 0; i < 1000; ++i) ASSERT_FALSE(watch.look());
}

}  // namespace
}  // namespace planlight
