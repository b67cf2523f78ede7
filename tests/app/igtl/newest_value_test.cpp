#include "app/igtl/newest_value.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace planlight {
namespace {

TEST(NewestValue, GivesTheNewestOnce) {
    NewestValue<int> box;
    int value = 7;
    EXPECT_FALSE(box.take(value));
    box.give(1);
    box.give(2);
    EXPECT_TRUE(box.take(value));
    EXPECT_EQ(value, 2);
    EXPECT_FALSE(box.take(value));
    EXPECT_EQ(value, 2);
}

TEST(NewestValue, IsNeverAMixtureOfTwoAndNeverGoesBack) {
    constexpr int kMany = 200000;
    NewestValue<std::vector<int>> box;
    std::thread giver([&] {
        for (int i = 1; i <= kMany; ++i) box.give(std::vector<int>(16, i));
    });
    std::vector<int> value;
    int last = 0;
    while (last < kMany) {
        if (!box.take(value)) continue;
        ASSERT_EQ(value.front(), value.back());
        ASSERT_GT(value.front(), last);
        last = value.front();
    }
    giver.join();
}

}  // namespace
}  // namespace planlight
