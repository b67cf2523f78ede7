#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "planning_io/types/pose_covariance.h"

namespace planlight {
namespace {

PoseCovariance shifts_of(const Eigen::Vector3d& sigma_mm) {
    PoseCovariance covariance;
    covariance.of_turn_and_shift.diagonal().tail<3>() = sigma_mm.cwiseAbs2();
    covariance.centre_in_ct = {10, 20, 30};
    return covariance;
}

TEST(PoseCovariance, TheBoundIsThatOfTheKnownDistributions) {
    // 95 % quantiles of |x| of one Gaussian number (1.960) and of the length of three (Maxwell, 2.795); the
    // approximation's error is 1.5 %.
    const Eigen::Vector3d anywhere(-70, 5, 200);
    EXPECT_NEAR(predicted_error(shifts_of({2, 0, 0}), anywhere).bound_95_mm, 2 * 1.960, 0.06);
    EXPECT_NEAR(predicted_error(shifts_of({2, 2, 2}), anywhere).bound_95_mm, 2 * 2.795, 0.08);
    EXPECT_NEAR(predicted_error(shifts_of({2, 2, 2}), anywhere).rms_mm, 2 * std::sqrt(3.), 1e-9);
}

TEST(PoseCovariance, ATurnMovesNothingOnItsAxisAndInProportionToTheLever) {
    PoseCovariance covariance;
    covariance.centre_in_ct = {10, 20, 30};
    covariance.of_turn_and_shift(2, 2) = 1e-4;  // 0.01 rad about z
    EXPECT_NEAR(predicted_error(covariance, {10, 20, 130}).rms_mm, 0, 1e-9);
    EXPECT_NEAR(predicted_error(covariance, {110, 20, 30}).rms_mm, 1, 1e-9);
    EXPECT_NEAR(predicted_error(covariance, {10, -180, 90}).rms_mm, 2, 1e-9);
}

TEST(PoseCovariance, NineteenOfTwentyRandomPosesAreWithinTheBound) {
    std::mt19937 random(3);
    std::normal_distribution<double> any;
    for (int trial = 0; trial < 5; ++trial) {
        Eigen::Matrix<double, 6, 6> root;
        for (double& entry : root.reshaped()) entry = any(random);
        root.topRows<3>() *= 0.005;  // radians; 100 mm away as much as a shift of half a millimetre
        PoseCovariance covariance;
        covariance.centre_in_ct = {5, 6, 7};
        covariance.of_turn_and_shift = root * root.transpose();
        const Eigen::Vector3d target(60, -40, 30);
        const double bound_mm = predicted_error(covariance, target).bound_95_mm;
        int within = 0;
        constexpr int kPoses = 20000;
        for (int i = 0; i < kPoses; ++i) {
            const Eigen::Matrix<double, 6, 1> pose =
                root * Eigen::Matrix<double, 6, 1>::NullaryExpr([&] { return any(random); });
            const Eigen::Vector3d moved = pose.head<3>().cross(target - covariance.centre_in_ct) + pose.tail<3>();
            within += moved.norm() <= bound_mm;
        }
        EXPECT_NEAR(static_cast<double>(within) / kPoses, 0.95, 0.01);
    }
}

TEST(PoseCovariance, NothingKnownIsSaidSo) {
    EXPECT_FALSE(PoseCovariance().known());
    EXPECT_TRUE(shifts_of({0, 0, 0.1}).known());
}

}  // namespace
}  // namespace planlight
