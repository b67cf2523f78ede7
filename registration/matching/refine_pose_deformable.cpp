#include "registration/matching/refine_pose_deformable.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "planning_io/types/statistics.h"
#include "registration/matching/plausible_skin.h"
#include "registration/matching/skin_patches.h"

namespace planlight {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

double median_size(const VectorXd& values) {
    std::vector<double> sizes;
    for (const double v : values) sizes.push_back(std::abs(v));
    return median(std::move(sizes));
}

/// Whether the patches would lie much farther from the skin after the step than before it.
bool leaves_the_skin(const DeformableProblem& problem, const Vector6d& step, const Vector3d& offset_mm) {
    constexpr double kMuch = 2, kAlways_mm = 0.2;
    const VectorXd after_mm = problem.residual_mm + problem.J * step - problem.offsets.col(0) * offset_mm[0];
    return median_size(after_mm) > kMuch * median_size(problem.residual_mm) + kAlways_mm;
}

DeformablePose one_step(const PointCloud& cloud, const SkinLut& lut, const RigidTransform& ct_from_rig,
                        const DeformableSettings& settings) {
    DeformablePose result;
    result.ct_from_rig = ct_from_rig;
    result.covariance.of_turn_and_shift.diagonal().setConstant(std::numeric_limits<double>::infinity());
    const std::vector<SkinPatch> patches = patches_of(cloud, lut, ct_from_rig, settings.max_patches);
    result.patches = static_cast<int>(patches.size());
    if (patches.size() < 24) return result;
    Vector3d centre = Vector3d::Zero();
    for (const SkinPatch& p : patches) centre += p.x_in_ct / static_cast<double>(patches.size());
    const DeformableProblem problem(patches, centre, settings);

    std::array<std::array<PlausibleSkin, kOwnParts.size()>, kCorrelations_mm.size()> judged;
    tbb::parallel_for(std::size_t{0}, kCorrelations_mm.size(), [&](std::size_t at) {
        const MatrixXd alike = problem.alike(kCorrelations_mm[at]);
        for (std::size_t j = 0; j < kOwnParts.size(); ++j)
            judged[at][j] = judge(problem, alike, kOwnParts[j], settings);
    });

    double best = -std::numeric_limits<double>::infinity(), sum = 0;
    for (const auto& of_length : judged)
        for (const PlausibleSkin& p : of_length) best = std::max(best, p.log_likelihood);
    if (!std::isfinite(best)) return result;
    Vector6d step = Vector6d::Zero();
    Matrix6d covariance = Matrix6d::Zero();
    double scale = 0, scale_squares = 0;
    Vector3d offset_mm = Vector3d::Zero();
    for (std::size_t i = 0; i < judged.size(); ++i)
        for (const PlausibleSkin& p : judged[i]) {
            if (!std::isfinite(p.log_likelihood)) continue;
            const double share = std::exp(p.log_likelihood - best);
            sum += share;
            step += share * p.step;
            covariance += share * (p.covariance + p.step * p.step.transpose());
            scale += share * p.scale;
            scale_squares += share * (settings.caution * p.scale_variance + p.scale * p.scale);
            result.movement_mm += share * std::sqrt(p.variance);
            result.correlation_mm += share * kCorrelations_mm[i];
            offset_mm += share * p.offset_mm;
        }
    result.scale = scale / sum;
    result.scale_sigma = std::sqrt(std::max(scale_squares / sum - result.scale * result.scale, 0.));
    step /= sum;
    result.movement_mm /= sum;
    result.correlation_mm /= sum;
    offset_mm /= sum;
    result.offset_mm = offset_mm[0];
    result.covariance.centre_in_ct = centre;
    result.covariance.of_turn_and_shift = settings.caution * (covariance / sum - step * step.transpose());
    if (leaves_the_skin(problem, step, offset_mm)) {
        // Long waves that the pose takes up nearly whole can be had of any height: then the residuals tell nothing of
        // it.
        result.covariance.of_turn_and_shift += step * step.transpose();
        step.setZero();
        result.offset_mm = 0;
    }
    const double pulled_mm = settings.pulled_share * result.movement_mm,
                 from_offset_mm = settings.offset_share * result.offset_mm;
    const double unseen_mm2 =
        pulled_mm * pulled_mm + from_offset_mm * from_offset_mm + settings.least_shift_mm * settings.least_shift_mm;
    result.covariance.of_turn_and_shift.diagonal().tail<3>().array() += unseen_mm2 / 3;
    const Vector3d turn = step.head<3>();
    RigidTransform moved = RigidTransform::Identity();
    if (turn.norm() > 0) moved.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
    moved.translation() = centre + Vector3d(step.tail<3>()) - moved.linear() * centre;
    result.ct_from_rig = moved * ct_from_rig;
    return result;
}

/// How far the scan lies from the skin at this pose, offset taken out: the median.
double off_skin_mm(const PointCloud& cloud, const SkinLut& lut, const RigidTransform& ct_from_rig, double offset_mm) {
    std::vector<double> off;
    for (const SkinPatch& p : points_on_skin(cloud, lut, ct_from_rig))
        off.push_back(std::abs(p.distance_mm - offset_mm));
    return median(std::move(off));
}

}  // namespace

DeformablePose refine_pose_deformable(const PointCloud& cloud, const SkinLut& lut, const RigidTransform& ct_from_rig,
                                      const DeformableSettings& settings) {
    DeformablePose result = one_step(cloud, lut, ct_from_rig, settings);
    // What lies off the skin is judged anew where the step led.
    for (int step = 1; step < settings.steps; ++step) result = one_step(cloud, lut, result.ct_from_rig, settings);
    // Steps that each leave the skin a little are not taken either.
    constexpr double kMuch = 1.3, kAlways_mm = 0.15;
    if (off_skin_mm(cloud, lut, result.ct_from_rig, result.offset_mm) >
        kMuch * off_skin_mm(cloud, lut, ct_from_rig, 0) + kAlways_mm) {
        const Vector3d shift = result.ct_from_rig * (ct_from_rig.inverse() * result.covariance.centre_in_ct) -
                               result.covariance.centre_in_ct;
        result.covariance.of_turn_and_shift.bottomRightCorner<3, 3>() += shift * shift.transpose();
        result.ct_from_rig = ct_from_rig;
        result.offset_mm = 0;
    }
    return result;
}

}  // namespace planlight
