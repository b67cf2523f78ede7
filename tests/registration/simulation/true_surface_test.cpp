#include "registration/simulation/true_surface.h"

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>

#include "registration/simulation/head_pose.h"
#include "tests/registration/simulation/analytic_volume.h"
#include "tests/support/analytic_head.h"

namespace planlight::simulation {

using Eigen::Vector3d;
using test::analytic_head_distance;

namespace {

const TrueSurface& head() {
    static const TrueSurface surface(test::volume_of_analytic_head(), -300);
    return surface;
}

Vector3d anywhere(std::mt19937& random) {
    std::normal_distribution<double> unit;
    return Vector3d(unit(random), unit(random), unit(random)).normalized();
}

}  // namespace

TEST(TrueSurface, RaysMeetTheAnalyticHead) {
    // 2 mm voxels of a distance field: trilinear interpolation is off by at most h^2 / 8 of the curvature, 0.05 mm on a
    // radius of 10 mm; a few places are sharper.
    std::mt19937 random(1);
    int hits = 0, off = 0;
    double sum = 0;
    for (int i = 0; i < 2000; ++i) {
        const Vector3d from = 500 * anywhere(random), to = 40 * anywhere(random);
        const auto hit = head().first_hit(from, (to - from).normalized());
        ASSERT_TRUE(hit);
        ++hits;
        const double d = analytic_head_distance(hit->p_in_ct);
        sum += d;
        if (std::abs(d) > 0.08) ++off;
        EXPECT_GT(hit->normal_in_ct.dot(test::analytic_head_normal(hit->p_in_ct)), 0.9);
    }
    EXPECT_LT(off, hits / 50);
    EXPECT_LT(std::abs(sum / hits), 0.02);
}

TEST(TrueSurface, NearestPointIsOnTheSkinAndTheDistanceHasTheRightSign) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> off(-3, 3);
    for (int i = 0; i < 500; ++i) {
        const Vector3d s = test::on_analytic_head(90 * anywhere(random));
        const double d_mm = off(random);
        const Vector3d p = s + d_mm * test::analytic_head_normal(s);
        const auto nearest = head().nearest(p);
        EXPECT_NEAR(analytic_head_distance(nearest.p_in_ct), 0, 0.12);
        EXPECT_NEAR(nearest.signed_mm, d_mm, 0.12 + 0.05 * std::abs(d_mm)) << s.transpose();
    }
}

TEST(TrueSurface, PlatesBesideTheHeadAreNotInTheRoom) {
    const TrueSurface with_plates(test::volume_of_analytic_head(true), -300);
    EXPECT_TRUE(with_plates.low_in_ct().isApprox(head().low_in_ct(), 1e-6));
    EXPECT_TRUE(with_plates.high_in_ct().isApprox(head().high_in_ct(), 1e-6));
    EXPECT_EQ(with_plates.triangle_count(), head().triangle_count());
}

TEST(TrueSurface, ThereIsNoHeadInAir) {
    Volume air = test::volume_of_analytic_head();
    std::fill(air.values.begin(), air.values.end(), -1000.0F);
    EXPECT_THROW(TrueSurface(air, -300), std::invalid_argument);
}

TEST(HeadPose, FacesTheProjectorWithinThirtyDegreesAtAnyRoll) {
    std::mt19937 random(3);
    const WorkRegion region = find_work_region(head(), {});
    Eigen::Vector3d mean_left = Vector3d::Zero();
    for (int i = 0; i < 400; ++i) {
        const RigidTransform room_from_ct = lay_head(head(), region, random);
        const Vector3d out = room_from_ct.linear() * region.outwards_in_ct;
        EXPECT_GT(out.dot(-Vector3d::UnitZ()), std::cos(30 * M_PI / 180));
        EXPECT_LT((room_from_ct * region.centre_in_ct).norm(), 90);  // mm from the working point
        mean_left += room_from_ct.linear() * Vector3d::UnitX() / 400;
    }
    EXPECT_LT(mean_left.norm(), 0.15);  // 3 sigma of 400 uniform directions in a plane
}

}  // namespace planlight::simulation
