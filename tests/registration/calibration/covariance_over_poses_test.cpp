#include "registration/calibration/covariance_over_poses.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "registration/calibration/bundle_adjustment.h"
#include "tests/registration/calibration/ideal_board.h"

namespace planlight {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kNumbers = 5, kRows = 80;

/// Poses of a linear model, each with an error of its own that its residuals have in common, beside their noise of 1.
std::vector<PoseInformation> poses_with(double common, int poses, std::mt19937& random) {
    std::normal_distribution<double> normal;
    std::vector<PoseInformation> all;
    for (int pose = 0; pose < poses; ++pose) {
        const MatrixXd J = MatrixXd::NullaryExpr(kRows, kNumbers, [&] { return 1 + 0.5 * normal(random); });
        const double shift = common * normal(random);
        const VectorXd r = VectorXd::NullaryExpr(kRows, [&] { return shift + normal(random); });
        all.push_back({J.transpose() * J, J.transpose() * r});
    }
    return all;
}

struct Sums {
    double true_square = 0, stated = 0, by_normal_matrix = 0;
};

/// Over many draws: the square of the estimate's error, what is stated, and what the normal matrix alone says.
Sums over_draws(double common, int poses) {
    std::mt19937 random(17);
    Sums sums;
    for (int draw = 0; draw < 400; ++draw) {
        const auto all = poses_with(common, poses, random);
        MatrixXd normal = MatrixXd::Zero(kNumbers, kNumbers);
        VectorXd score = VectorXd::Zero(kNumbers);
        for (const auto& pose : all) {
            normal += pose.normal;
            score += pose.score;
        }
        const VectorXd off = normal.ldlt().solve(score);
        std::vector<PoseInformation> at_estimate = all;
        for (auto& pose : at_estimate) pose.score -= pose.normal * off;
        const auto stated = covariance_over_poses(at_estimate, MatrixXd::Zero(kNumbers, kNumbers));
        sums.true_square += off.squaredNorm();
        sums.stated += stated.covariance.trace();
        sums.by_normal_matrix += normal.inverse().trace();
    }
    return sums;
}

// 400 draws of 5 numbers leave a tenth open. Leaving out one of eight poses is a little pessimistic, never the other
// way.
TEST(CovarianceOverPoses, IndependentErrorsAreStatedAsTheNormalMatrixSaysOrALittleLarger) {
    const Sums sums = over_draws(0, 8);
    EXPECT_NEAR(sums.true_square / sums.by_normal_matrix, 1, 0.1);
    EXPECT_GT(sums.true_square / sums.stated, 0.7);
    EXPECT_LT(sums.true_square / sums.stated, 1.1);
}

// A pose whose 80 residuals share an error of 0.7 of their noise says as much as a few residuals. The fewer the poses,
// the more pessimistic: with five the stated sigma is 1.4 times the true error.
TEST(CovarianceOverPoses, ErrorsThatAPoseHasInCommonAreStatedAndTheNormalMatrixAloneIsBlindToThem) {
    for (const int poses : {5, 8, 14}) {
        const Sums sums = over_draws(0.7, poses);
        EXPECT_GT(sums.true_square / sums.by_normal_matrix, 1.8);
        EXPECT_GT(sums.true_square / sums.stated, 0.4) << poses;
        EXPECT_LT(sums.true_square / sums.stated, 1.2) << poses;
    }
}

TEST(CovarianceOverPoses, TwoPosesCannotContradictEachOtherEnoughToBeAsked) {
    std::mt19937 random(3);
    const auto two = poses_with(5, 2, random);
    const MatrixXd prior = MatrixXd::Identity(kNumbers, kNumbers);
    const auto stated = covariance_over_poses(two, prior);
    EXPECT_EQ(stated.factor, 1);
    EXPECT_LT((stated.covariance - (two[0].normal + two[1].normal + prior).inverse()).norm(), 1e-9);
}

// What no pose tells stays as uncertain as the prior says, and the answer is finite.
TEST(CovarianceOverPoses, ANumberThatOnlyThePriorKnowsKeepsItsUncertainty) {
    std::mt19937 random(5);
    auto poses = poses_with(0, 8, random);
    for (auto& pose : poses) {
        pose.normal.row(4).setZero();
        pose.normal.col(4).setZero();
        pose.score = VectorXd::Zero(kNumbers);
    }
    MatrixXd prior = MatrixXd::Zero(kNumbers, kNumbers);
    prior(4, 4) = 4;
    const auto stated = covariance_over_poses(poses, prior);
    ASSERT_TRUE(stated.covariance.allFinite());
    EXPECT_NEAR(stated.covariance(4, 4), 0.25, 1e-6);
}

/// Light that a pose shifts by 0.05 px rms (its noise is 0.08 px a sample, of thousands): sample by sample that says
/// nothing, but it is most of the projector's error.
TEST(CovarianceOverPoses, OfARigCountsErrorsThatAPoseHasInCommon) {
    const test::IdealRoom room = test::ideal_room();
    RigEstimate truth;
    truth.devices = {room.rig.left_camera, room.rig.right_camera, room.rig.projector};
    const RigidTransform rig_from_left = room.rig.left_camera.device_from_rig.inverse();
    for (auto& device : truth.devices) device->device_from_rig = device->device_from_rig * rig_from_left;
    for (const auto& pose : room.rig_from_board) truth.rig_from_board.push_back(rig_from_left.inverse() * pose);
    const Eigen::VectorXd wanted = numbers_of(truth);
    double sum = 0;
    int count = 0;
    for (unsigned seed = 1; seed <= 3; ++seed) {
        auto poses = room.observe(seed);
        std::mt19937 random(seed);
        std::normal_distribution<double> shift_px(0, 0.05);
        for (auto& pose : poses) {
            const Eigen::Vector2d shift(shift_px(random), shift_px(random)), tilt(shift_px(random), shift_px(random));
            for (auto* seen : {&pose.left, &pose.right})
                for (LightSample& sample : seen->light)
                    sample.pixel_in_projector += shift + tilt * (sample.pixel_in_projector.x() - 400) / 200;
        }
        const BundleResult bundle = adjust_bundle(poses, room.board, truth);
        EXPECT_GT(bundle.uncertainty_factor, 1.5);
        const Eigen::VectorXd off = numbers_of(bundle.rig) - wanted;
        for (Eigen::Index i = 24; i < 39; ++i) {
            if (i == 32) continue;  // k3 stands still
            sum += off[i] * off[i] / bundle.covariance(i, i);
            ++count;
        }
    }
    EXPECT_GT(sum / count, 0.3);
    EXPECT_LT(sum / count, 3);
}

}  // namespace
}  // namespace planlight
