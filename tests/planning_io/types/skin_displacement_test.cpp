#include "planning_io/types/skin_displacement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace planlight {
namespace {

using Eigen::Vector3d;

/// A flat piece of skin of 80 mm, 0.4 mm inside of the CT's, with a wave of 0.2 mm and 60 mm over it.
double wave_mm(const Vector3d& p) {
    return -0.4 + 0.2 * std::sin(p.x() * 2 * M_PI / 60);
}
SkinDisplacement waved() {
    SkinDisplacement d;
    d.apart_mm = 4, d.offset_mm = -0.4, d.spread_mm = 0.15, d.alike_over_mm = 25;
    for (double x = -40; x <= 40; x += 4)
        for (double y = -40; y <= 40; y += 4) {
            const Vector3d p(x, y, 0);
            d.places.push_back({p, wave_mm(p), 0.02});
        }
    return d;
}

// Between places 4 mm apart the wave bends by 0.2 (2 pi 2/60)^2 / 2 = 0.004 mm; the rest is what 0.02 mm of noise
// allow.
TEST(SkinDisplacement, FollowsWhatTheScanFound) {
    const SkinDisplacementField field(waved());
    for (double x = -35; x <= 35; x += 3.1)
        for (double y = -35; y <= 35; y += 5.3) {
            const auto value = field.at({x, y, 0.3});
            EXPECT_NEAR(value.mm, wave_mm({x, y, 0}), 0.02);
            EXPECT_TRUE(value.scanned);
            EXPECT_LT(value.sigma_mm, 0.08);
        }
}

TEST(SkinDisplacement, OffTheScanGoesBackToTheOffsetAndSaysHowUnsureThatIs) {
    const SkinDisplacementField field(waved());
    const auto beside = field.at({52, 0, 0}), far = field.at({300, 0, 0});
    EXPECT_FALSE(beside.scanned);
    EXPECT_FALSE(far.scanned);
    EXPECT_NEAR(far.mm, -0.4, 1e-3);
    EXPECT_NEAR(far.sigma_mm, 0.15, 1e-3);
    EXPECT_GT(beside.sigma_mm, 0.08);
    EXPECT_LT(beside.sigma_mm, 0.15);
}

TEST(SkinDisplacement, NothingKnownIsNoDisplacement) {
    const SkinDisplacementField field((SkinDisplacement()));
    EXPECT_EQ(field.at({1, 2, 3}).mm, 0);
    EXPECT_FALSE(field.at({1, 2, 3}).scanned);
}

TEST(SkinDisplacement, RefusesNumbersThatCannotBe) {
    for (int fault = 0; fault < 4; ++fault) {
        SkinDisplacement d = waved();
        if (fault == 0) d.places[3].mm = std::numeric_limits<double>::quiet_NaN();
        if (fault == 1) d.places[5].sigma_mm = 0;
        if (fault == 2) d.alike_over_mm = 0;
        if (fault == 3) d.offset_mm = std::numeric_limits<double>::infinity();
        EXPECT_THROW(SkinDisplacementField{d}, std::invalid_argument) << fault;
    }
}

}  // namespace
}  // namespace planlight
