#include "app/evaluation/log_histogram.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace planlight {
namespace {

std::vector<double> errors(unsigned seed, int count, double scale) {
    std::mt19937 random(seed);
    std::normal_distribution<double> error(0, scale);
    std::vector<double> values;
    for (int i = 0; i < count; ++i) values.push_back(std::abs(error(random)));
    return values;
}

// The whole sample's own figures: a bin is one per cent wide, its middle half of that from any value in it.
TEST(LogHistogram, JoinedSamplesHaveTheFiguresOfTheWholeToHalfAPerCent) {
    std::vector<double> all;
    LogHistogram joined;
    for (unsigned part = 1; part <= 5; ++part) {
        const auto values = errors(part, 1000, 0.1 * part);
        all.insert(all.end(), values.begin(), values.end());
        joined.add(LogHistogram::from_text(histogram_of(values).text()));
    }
    const Distribution whole = distribution_of(all), found = joined.distribution();
    EXPECT_EQ(found.count, whole.count);
    EXPECT_NEAR(found.median, whole.median, 0.0051 * whole.median);
    EXPECT_NEAR(found.p95, whole.p95, 0.0051 * whole.p95);
    EXPECT_EQ(found.worst, whole.worst);  // bit for bit
}

TEST(LogHistogram, KeepsZeroEmptyAndNoNumber) {
    EXPECT_EQ(LogHistogram{}.distribution().count, 0u);
    EXPECT_EQ(LogHistogram::from_text(LogHistogram{}.text()).distribution().count, 0u);
    EXPECT_EQ(histogram_of({0, 0, 0}).distribution().p95, 0);
    const auto odd = LogHistogram::from_text(histogram_of({1, std::nan(""), 2}).text()).distribution();
    EXPECT_TRUE(std::isnan(odd.worst));
    EXPECT_NEAR(odd.median, 2, 0.011);
}

TEST(LogHistogram, AnythingElseIsNotTakenForOne) {
    for (const char* text : {"", "5:1", "x:1 <=2", "5:x <=2", "5 <=2", "5:1 <=y", "<=1 5:1"})
        EXPECT_THROW(LogHistogram::from_text(text), std::invalid_argument) << text;
}

}  // namespace
}  // namespace planlight
