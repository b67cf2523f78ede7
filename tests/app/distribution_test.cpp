#include "app/evaluation/distribution.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace planlight {
namespace {

TEST(Distribution, OfOneToAHundred) {
    std::vector<double> values(100);
    std::iota(values.rbegin(), values.rend(), 1.0);
    const auto d = distribution_of(values);
    EXPECT_EQ(d.count, 100u);
    EXPECT_DOUBLE_EQ(d.median, 50);
    EXPECT_DOUBLE_EQ(d.p95, 95);
    EXPECT_DOUBLE_EQ(d.worst, 100);
}

TEST(Distribution, ANanIsTheWorstAndNeverHidden) {
    EXPECT_TRUE(std::isnan(distribution_of({1, std::nan(""), 2}).worst));
}

TEST(Distribution, OfNothingCountsNothing) {
    EXPECT_EQ(distribution_of({}).count, 0u);
}

}  // namespace
}  // namespace planlight
