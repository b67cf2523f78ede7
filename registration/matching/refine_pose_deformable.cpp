#include "registration/matching/refine_pose_deformable.h"

#include <tbb/parallel_for.h>

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include "planning_io/types/statistics.h"
#include "planning_io/types/triangle_mesh.h"
#include "registration/matching/distance_field.h"
#include "registration/matching/gauss_newton.h"

namespace planlight {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// The scan's points of one place on the skin.
struct Patch {
    Vector3d x_in_ct = Vector3d::Zero(), normal = Vector3d::Zero();
    double distance_mm = 0;
    std::vector<double> distances_mm;
    double thickness_mm = 0;  ///< mean over the points for which it is known
    double known_thickness = 0;
};

/// The scan in patches of about equal size, about `count` of them; those of fewer than a few points are left out.
std::vector<Patch> patches_of(const PointCloud& cloud, const SkinLut& lut, const RigidTransform& ct_from_rig,
                              int count) {
    constexpr double kFar_mm = 6;
    const DistanceField field(lut);
    std::vector<Patch> points;
    const std::size_t stride = std::max<std::size_t>(1, cloud.size() / 20000);
    for (std::size_t i = 0; i < cloud.size(); i += stride) {
        if (!cloud.points_in_rig[i].allFinite()) continue;
        Patch p;
        p.x_in_ct = ct_from_rig * cloud.points_in_rig[i];
        const SkinPoint* s = lut.nearest_skin(p.x_in_ct);
        if (!s || s->flags != kSkin || !field.sample(p.x_in_ct, p.distance_mm, p.normal)) continue;
        if (!(std::abs(p.distance_mm) < kFar_mm)) continue;
        if (std::isfinite(s->thickness_mm)) p.thickness_mm = s->thickness_mm, p.known_thickness = 1;
        points.push_back(p);
    }
    const auto gathered = [&](double cell_mm) {
        std::map<std::array<int, 3>, Patch> cells;
        for (const Patch& p : points) {
            const Eigen::Vector3i cell = (p.x_in_ct / cell_mm).array().floor().cast<int>();
            Patch& into = cells[{cell.x(), cell.y(), cell.z()}];
            into.x_in_ct += p.x_in_ct;
            into.normal += p.normal;
            into.distances_mm.push_back(p.distance_mm);
            into.thickness_mm += p.thickness_mm;
            into.known_thickness += p.known_thickness;
        }
        std::vector<Patch> patches;
        for (auto& [cell, patch] : cells) {
            const auto n = patch.distances_mm.size();
            if (n < 4) continue;
            const auto middle = patch.distances_mm.begin() + static_cast<std::ptrdiff_t>(n / 2);
            std::nth_element(patch.distances_mm.begin(), middle, patch.distances_mm.end());
            patch.distance_mm = *middle;  // strays do not move the median
            patch.x_in_ct /= static_cast<double>(n);
            patch.normal.normalize();
            if (patch.known_thickness > 0) patch.thickness_mm /= patch.known_thickness;
            patches.push_back(patch);
        }
        return patches;
    };
    double cell_mm = 6;
    std::vector<Patch> patches = gathered(cell_mm);
    for (int i = 0; i < 12 && static_cast<int>(patches.size()) > count; ++i) {
        cell_mm *= std::clamp(std::sqrt(static_cast<double>(patches.size()) / count), 1.05, 3.0);
        patches = gathered(cell_mm);
    }
    return patches;
}

/// How likely one possible skin is (over what length it is alike, how large each patch's own part is), and what pose,
/// covariance, offset and scale are if it is so.
struct Plausible {
    double log_likelihood = -std::numeric_limits<double>::infinity();
    double variance = 0;               ///< of the field, mm^2
    Vector6d step = Vector6d::Zero();  ///< from the pose that was given to the best one under such a skin
    Matrix6d covariance = Matrix6d::Zero();
    double offset_mm = 0;
    double scale = 1, scale_variance = 0;
};

/// How much of a patch's own it has: 1 near the skin, more the farther it lies off, so that what moved as a piece (a
/// jaw, a drape's edge) does not pull the pose. Scaled by the median, so that skin which moved as a whole is not left
/// out.
VectorXd own_parts(const VectorXd& residual_mm) {
    constexpr double kLeastScale_mm = 0.3, kMedians = 1.5, kLeastWeight = 0.02, kBeyond = 20;
    std::vector<double> sizes(residual_mm.data(), residual_mm.data() + residual_mm.size());
    for (double& size : sizes) size = std::abs(size);
    const auto middle = median(sizes);
    const double scale_mm = std::max(kLeastScale_mm, kMedians * middle);
    return residual_mm.unaryExpr([&](double r) {
        const double beyond = std::max(0., std::abs(r) / scale_mm - 2);
        return 1 / std::max(kLeastWeight, tukey_weight(r, scale_mm)) + kBeyond * beyond * beyond;
    });
}

/// How far each patch's skin is likely to move, against the typical patch: the more the thicker the soft tissue is over
/// the bone, where the table knows. 1 for all where it does not (MRI).
VectorXd softness(const std::vector<Patch>& patches, double given_mm) {
    constexpr double kLeast = 0.4, kMost = 2.5;
    std::vector<double> known;
    for (const Patch& p : patches)
        if (p.known_thickness > 0) known.push_back(p.thickness_mm + given_mm);
    VectorXd soft = VectorXd::Ones(static_cast<Eigen::Index>(patches.size()));
    if (known.size() < patches.size() / 4 || !(given_mm >= 0) || !std::isfinite(given_mm)) return soft;
    const auto middle = median(known);
    for (std::size_t i = 0; i < patches.size(); ++i)
        if (patches[i].known_thickness > 0)
            soft[static_cast<Eigen::Index>(i)] =
                std::clamp((patches[i].thickness_mm + given_mm) / middle, kLeast, kMost);
    return soft;
}

struct Problem {
    MatrixXd J;  ///< patches x 6
    VectorXd residual_mm;
    VectorXd own;          ///< of each patch: more where it lies far off
    VectorXd growth_mm;    ///< of the distance, when the scan grows to twice its size
    MatrixXd squared_mm2;  ///< distances of patches
    VectorXd soft;         ///< how far each is likely to move, against the typical one

    Problem(const std::vector<Patch>& patches, const Vector3d& centre, const DeformableSettings& settings)
        : soft(softness(patches, settings.thickness_floor_mm)) {
        const auto n = static_cast<Eigen::Index>(patches.size());
        J.resize(n, 6);
        residual_mm.resize(n);
        squared_mm2.resize(n, n);
        growth_mm.resize(n);
        for (Eigen::Index i = 0; i < n; ++i) {
            const Patch& p = patches[static_cast<std::size_t>(i)];
            J.row(i) << (p.x_in_ct - centre).cross(p.normal).transpose(), p.normal.transpose();
            residual_mm[i] = p.distance_mm;
            growth_mm[i] = (p.x_in_ct - centre).dot(p.normal);
            for (Eigen::Index j = 0; j < n; ++j)
                squared_mm2(i, j) = (p.x_in_ct - patches[static_cast<std::size_t>(j)].x_in_ct).squaredNorm();
        }
        own = own_parts(residual_mm).cwiseProduct(soft.cwiseAbs2());
    }
    MatrixXd alike(double correlation_mm) const {
        return soft.asDiagonal() * (-squared_mm2.array() / (2 * correlation_mm * correlation_mm)).exp().matrix() *
               soft.asDiagonal();
    }
};

/// Generalised least squares of the pose and of an offset of the whole skin (another threshold, swelling all over),
/// which has a prior. A field smaller than the least movement is not believed.
Plausible judge(const Problem& problem, const MatrixXd& alike, double own, const DeformableSettings& settings) {
    using Matrix7d = Eigen::Matrix<double, 7, 7>;
    using Vector7d = Eigen::Matrix<double, 7, 1>;
    const auto n = problem.residual_mm.size();
    MatrixXd K = alike;
    K.diagonal() += own * problem.own;
    const Eigen::LLT<MatrixXd> factor(K);
    if (factor.info() != Eigen::Success) return {};
    MatrixXd X(n, 7);
    X << problem.J, VectorXd::Ones(n);
    const MatrixXd KX = factor.solve(X);
    Matrix7d M = X.transpose() * KX;
    const VectorXd Kr = factor.solve(problem.residual_mm);
    const Vector7d taken = X.transpose() * Kr;
    const double freedom = static_cast<double>(n - 7);
    Plausible result;
    {
        const Eigen::LLT<Matrix7d> small(M);
        if (small.info() != Eigen::Success) return {};
        const double Q = problem.residual_mm.dot(Kr) - taken.dot(small.solve(taken));
        result.variance = std::max(Q, 1e-12) / freedom;
        const double log_K = 2 * factor.matrixLLT().diagonal().array().log().sum();
        const double log_M = 2 * small.matrixLLT().diagonal().array().log().sum();
        result.log_likelihood = -0.5 * (log_K + log_M + freedom * std::log(result.variance));
    }
    result.variance = std::max(result.variance, settings.least_movement_mm * settings.least_movement_mm);
    M(6, 6) += result.variance / (settings.offset_prior_mm * settings.offset_prior_mm);
    const Eigen::LLT<Matrix7d> with_prior(M);
    if (with_prior.info() != Eigen::Success) return {};
    const Vector7d found = with_prior.solve(taken);
    const Matrix7d covariance = result.variance * with_prior.solve(Matrix7d::Identity());
    result.step = -found.head<6>();
    result.offset_mm = found[6];
    result.covariance = covariance.topLeftCorner<6, 6>();

    // What a growing scan would explain beyond pose and offset.
    const VectorXd Kg = factor.solve(problem.growth_mm);
    const Vector7d shared = X.transpose() * Kg, explained = with_prior.solve(shared);
    const double information = problem.growth_mm.dot(Kg) - shared.dot(explained);
    if (information > 0) {
        result.scale = 1 - (problem.growth_mm.dot(Kr) - shared.dot(found)) / information;
        result.scale_variance = result.variance / information;
    }
    return result;
}

double median_size(const VectorXd& values) {
    std::vector<double> sizes;
    for (const double v : values) sizes.push_back(std::abs(v));
    return median(std::move(sizes));
}

/// Whether the patches would lie much farther from the skin after the step than before it.
bool leaves_the_skin(const Problem& problem, const Vector6d& step, double offset_mm) {
    constexpr double kMuch = 2, kAlways_mm = 0.2;
    const VectorXd after_mm =
        problem.residual_mm + problem.J * step - VectorXd::Constant(problem.residual_mm.size(), offset_mm);
    return median_size(after_mm) > kMuch * median_size(problem.residual_mm) + kAlways_mm;
}

}  // namespace

DeformablePose refine_pose_deformable(const PointCloud& cloud, const SkinLut& lut, const RigidTransform& ct_from_rig,
                                      const DeformableSettings& settings) {
    DeformablePose result;
    result.ct_from_rig = ct_from_rig;
    result.covariance.of_turn_and_shift.diagonal().setConstant(std::numeric_limits<double>::infinity());
    const std::vector<Patch> patches = patches_of(cloud, lut, ct_from_rig, settings.max_patches);
    result.patches = static_cast<int>(patches.size());
    if (patches.size() < 24) return result;
    Vector3d centre = Vector3d::Zero();
    for (const Patch& p : patches) centre += p.x_in_ct / static_cast<double>(patches.size());
    const Problem problem(patches, centre, settings);

    constexpr std::array kCorrelations_mm{10., 15., 22., 33., 50., 75.};
    constexpr std::array kOwns{0.01, 0.1, 1., 10.};
    std::array<std::array<Plausible, kOwns.size()>, kCorrelations_mm.size()> judged;
    tbb::parallel_for(std::size_t{0}, kCorrelations_mm.size(), [&](std::size_t at) {
        const MatrixXd alike = problem.alike(kCorrelations_mm[at]);
        for (std::size_t j = 0; j < kOwns.size(); ++j) judged[at][j] = judge(problem, alike, kOwns[j], settings);
    });

    double best = -std::numeric_limits<double>::infinity(), sum = 0;
    for (const auto& of_length : judged)
        for (const Plausible& p : of_length) best = std::max(best, p.log_likelihood);
    if (!std::isfinite(best)) return result;
    Vector6d step = Vector6d::Zero();
    Matrix6d covariance = Matrix6d::Zero();
    double scale = 0, scale_squares = 0;
    for (std::size_t i = 0; i < judged.size(); ++i)
        for (const Plausible& p : judged[i]) {
            if (!std::isfinite(p.log_likelihood)) continue;
            const double share = std::exp(p.log_likelihood - best);
            sum += share;
            step += share * p.step;
            covariance += share * (p.covariance + p.step * p.step.transpose());
            scale += share * p.scale;
            scale_squares += share * (settings.caution * p.scale_variance + p.scale * p.scale);
            result.movement_mm += share * std::sqrt(p.variance);
            result.correlation_mm += share * kCorrelations_mm[i];
            result.offset_mm += share * p.offset_mm;
        }
    result.scale = scale / sum;
    result.scale_sigma = std::sqrt(std::max(scale_squares / sum - result.scale * result.scale, 0.));
    step /= sum;
    result.movement_mm /= sum;
    result.correlation_mm /= sum;
    result.offset_mm /= sum;
    result.covariance.centre_in_ct = centre;
    result.covariance.of_turn_and_shift = settings.caution * (covariance / sum - step * step.transpose());
    if (leaves_the_skin(problem, step, result.offset_mm)) {
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

}  // namespace planlight
