#include "planning_io/types/rigid_transform.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

namespace planlight {
namespace {

TEST(RigidTransform, AQuarterTurnAboutZTakesXToY) {
    Eigen::Matrix<double, 6, 1> twist;
    twist << 0, 0, std::numbers::pi / 2, 1, 2, 3;
    const RigidTransform t = transform_from_twist(twist);
    EXPECT_LT((t * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(1, 3, 3)).norm(), 1e-12);
}

TEST(RigidTransform, TheRotationVectorComesBack) {
    const Eigen::Vector3d w(0.4, -1.1, 0.9);
    Eigen::Matrix<double, 6, 1> twist;
    twist << w, 0, 0, 0;
    EXPECT_LT((rotation_vector(transform_from_twist(twist).linear()) - w).norm(), 1e-12);
    EXPECT_NEAR(angle_between(transform_from_twist(twist), RigidTransform::Identity()), w.norm(), 1e-12);
}

TEST(RigidTransform, FitFindsTheTransformOfThreePointsAndNeverAMirror) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> value(-1, 1);
    for (int trial = 0; trial < 50; ++trial) {
        Eigen::Matrix<double, 6, 1> twist;
        for (int i = 0; i < 6; ++i) twist[i] = (i < 3 ? 1.5 : 100) * value(random);
        const RigidTransform b_from_a = transform_from_twist(twist);
        Eigen::Matrix3Xd a(3, 3), b(3, 3);
        for (int c = 0; c < 3; ++c) {
            a.col(c) = 80 * Eigen::Vector3d(value(random), value(random), value(random));
            b.col(c) = b_from_a * Eigen::Vector3d(a.col(c));
        }
        const RigidTransform found = fit_rigid_transform(a, b);
        EXPECT_LT((found.matrix() - b_from_a.matrix()).norm(), 1e-7);
        b.row(0) = -b.row(0);  // a mirrored triangle still gets a rotation
        EXPECT_GT(fit_rigid_transform(a, b).linear().determinant(), 0);
    }
}

TEST(RigidTransform, WhatIsNoRotationIsNotRigid) {
    Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
    EXPECT_TRUE(is_rigid(m));
    m(0, 0) = -1;
    EXPECT_FALSE(is_rigid(m)) << "a mirror";
    m(0, 0) = 1.01;
    EXPECT_FALSE(is_rigid(m)) << "a stretch";
    m(0, 0) = std::nan("");
    EXPECT_FALSE(is_rigid(m));
    m = Eigen::Matrix4d::Identity();
    m(3, 0) = 0.1;
    EXPECT_FALSE(is_rigid(m)) << "a perspective row";
}

}  // namespace
}  // namespace planlight
