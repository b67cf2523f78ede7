#include "registration/matching/plausible_skin.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "planning_io/types/statistics.h"
#include "registration/matching/gauss_newton.h"

namespace planlight {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// How much of a patch's own it has: 1 near the skin, more the farther it lies off, so that what moved as a piece (a
/// jaw, a drape's edge) does not pull the pose. Scaled by the median, so that skin which moved by much is not left
/// out.
VectorXd own_parts(const VectorXd& residual_mm) {
    constexpr double kLeastScale_mm = 0.15, kMedians = 1.5, kLeastWeight = 0.02, kBeyond = 20;
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
VectorXd softness(const std::vector<SkinPatch>& patches, double given_mm) {
    constexpr double kLeast = 0.4, kMost = 2.5;
    std::vector<double> known;
    for (const SkinPatch& p : patches)
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

}  // namespace

DeformableProblem::DeformableProblem(const std::vector<SkinPatch>& patches, const Vector3d& centre,
                                     const DeformableSettings& settings)
    : soft(softness(patches, settings.thickness_floor_mm)) {
    const auto n = static_cast<Eigen::Index>(patches.size());
    J.resize(n, 6);
    offsets.resize(n, 3);
    residual_mm.resize(n);
    squared_mm2.resize(n, n);
    growth_mm.resize(n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const SkinPatch& p = patches[static_cast<std::size_t>(i)];
        J.row(i) << (p.turned - centre.cross(p.normal)).transpose(), p.normal.transpose();
        offsets.row(i) = p.offsets.transpose();
        residual_mm[i] = p.distance_mm;
        growth_mm[i] = (p.x_in_ct - centre).dot(p.normal);
        for (Eigen::Index j = 0; j < n; ++j)
            squared_mm2(i, j) = (p.x_in_ct - patches[static_cast<std::size_t>(j)].x_in_ct).squaredNorm();
    }
    // From the skin's own offset, so that skin which moved as a whole is not left out.
    const double middle_mm = median(std::vector<double>(residual_mm.data(), residual_mm.data() + n));
    own = own_parts(residual_mm.array() - middle_mm).cwiseProduct(soft.cwiseAbs2());
}

MatrixXd DeformableProblem::alike(double correlation_mm) const {
    return soft.asDiagonal() * (-squared_mm2.array() / (2 * correlation_mm * correlation_mm)).exp().matrix() *
           soft.asDiagonal();
}

PlausibleSkin judge(const DeformableProblem& problem, const MatrixXd& alike, double own,
                    const DeformableSettings& settings) {
    constexpr int kColumns = 9;
    using Matrix9d = Eigen::Matrix<double, kColumns, kColumns>;
    using Vector9d = Eigen::Matrix<double, kColumns, 1>;
    const auto n = problem.residual_mm.size();
    MatrixXd K = alike;
    K.diagonal() += own * problem.own;
    const Eigen::LLT<MatrixXd> factor(K);
    if (factor.info() != Eigen::Success) return {};
    MatrixXd X(n, kColumns);
    X << problem.J, problem.offsets;
    const MatrixXd KX = factor.solve(X);
    const Matrix9d M = X.transpose() * KX;
    const VectorXd Kr = factor.solve(problem.residual_mm);
    const Vector9d taken = X.transpose() * Kr;
    const double freedom = static_cast<double>(n - kColumns);
    PlausibleSkin result;
    {
        const Eigen::LLT<Matrix9d> small(M);
        if (small.info() != Eigen::Success) return {};
        const double Q = problem.residual_mm.dot(Kr) - taken.dot(small.solve(taken));
        result.variance = std::max(Q, 1e-12) / freedom;
        const double log_K = 2 * factor.matrixLLT().diagonal().array().log().sum();
        const double log_M = 2 * small.matrixLLT().diagonal().array().log().sum();
        result.log_likelihood = -0.5 * (log_K + log_M + freedom * std::log(result.variance));
    }
    result.variance = std::max(result.variance, settings.least_movement_mm * settings.least_movement_mm);
    const auto with_prior = [&](double offset_mm) {
        const double uneven_mm = settings.least_movement_mm + settings.uneven_share * std::abs(offset_mm);
        Matrix9d given = M;
        given(6, 6) += result.variance / (settings.offset_prior_mm * settings.offset_prior_mm);
        given(7, 7) += result.variance / (uneven_mm * uneven_mm);
        given(8, 8) += result.variance / (uneven_mm * uneven_mm);
        return Eigen::LLT<Matrix9d>(given);
    };
    const Eigen::LLT<Matrix9d> first = with_prior(settings.offset_prior_mm);
    if (first.info() != Eigen::Success) return {};
    const Eigen::LLT<Matrix9d> prior = with_prior(first.solve(taken)[6]);
    if (prior.info() != Eigen::Success) return {};
    const Vector9d found = prior.solve(taken);
    const Matrix9d covariance = result.variance * prior.solve(Matrix9d::Identity());
    result.step = -found.head<6>();
    result.offset_mm = found.tail<3>();
    result.covariance = covariance.topLeftCorner<6, 6>();

    // What a growing scan would explain beyond pose and offset.
    const VectorXd Kg = factor.solve(problem.growth_mm);
    const Vector9d shared = X.transpose() * Kg, explained = prior.solve(shared);
    const double information = problem.growth_mm.dot(Kg) - shared.dot(explained);
    if (information > 0) {
        result.scale = 1 - (problem.growth_mm.dot(Kr) - shared.dot(found)) / information;
        result.scale_variance = result.variance / information;
    }
    return result;
}

}  // namespace planlight
