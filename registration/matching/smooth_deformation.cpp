#include "registration/matching/smooth_deformation.h"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "planning_io/types/statistics.h"
#include "registration/matching/plausible_skin.h"
#include "registration/matching/skin_patches.h"

namespace planlight {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int kModes = 9, kPose = 6;
constexpr std::array kTimes{1., 3., 10.};  // how large the modes may be against the skin's own movement, one sigma

/// How a place moves by each mode.
Eigen::Matrix<double, 3, kModes> modes_at(const Vector3d& x) {
    Eigen::Matrix<double, 3, kModes> moved = Eigen::Matrix<double, 3, kModes>::Zero();
    for (Index a = 0; a < 3; ++a) {
        const Index b = (a + 1) % 3, c = (a + 2) % 3;
        moved(a, a) = x[a];                                    // longer along an axis
        moved(b, 3 + a) = x[c], moved(c, 3 + a) = x[b];        // sheared
        moved.col(6 + a) = x[a] * Vector3d::Unit(a).cross(x);  // twisted about an axis
    }
    return moved;
}

/// Movements of all places: three rows a place.
struct Movements {
    MatrixXd rigid;  ///< by a turn about the centre and a shift
    MatrixXd modes;  ///< by each mode, less what a rigid one does; 1 mm rms each

    Movements(const std::vector<SkinPatch>& patches, const Vector3d& centre) {
        const auto n = static_cast<Index>(patches.size());
        rigid.resize(3 * n, kPose);
        modes.resize(3 * n, kModes);
        for (Index i = 0; i < n; ++i) {
            const Vector3d x = patches[static_cast<std::size_t>(i)].x_in_ct - centre;
            modes.middleRows<3>(3 * i) = modes_at(x);
            for (Index a = 0; a < 3; ++a) {
                rigid.block<3, 1>(3 * i, a) = Vector3d::Unit(a).cross(x);
                rigid.block<3, 1>(3 * i, 3 + a) = Vector3d::Unit(a);
            }
        }
        modes -= rigid * (rigid.transpose() * rigid).ldlt().solve(rigid.transpose() * modes);
        for (Index k = 0; k < kModes; ++k) {
            const double rms = modes.col(k).norm() / std::sqrt(static_cast<double>(n));
            modes.col(k) /= std::max(rms, 1e-9);
        }
    }
};

/// Models of one kind, averaged by their likelihood: the sums are of `likelihood` times what they are of.
struct Average {
    double log_scale = -std::numeric_limits<double>::infinity(), sum = 0;
    Eigen::Matrix<double, kPose, 1> pose = Eigen::Matrix<double, kPose, 1>::Zero();
    Eigen::Matrix<double, kModes, 1> modes = Eigen::Matrix<double, kModes, 1>::Zero();

    void add(double log_likelihood, const VectorXd& found) {
        if (!std::isfinite(log_likelihood)) return;
        if (log_likelihood > log_scale) {
            const double smaller = std::exp(log_scale - log_likelihood);
            sum *= smaller, pose *= smaller, modes *= smaller;
            log_scale = log_likelihood;
        }
        const double likelihood = std::exp(log_likelihood - log_scale);
        sum += likelihood;
        pose += likelihood * found.head<kPose>();
        if (found.size() > kModes + kPose) modes += likelihood * found.tail<kModes>();
    }
    double log_sum() const { return log_scale + std::log(sum); }
};

struct Solution {
    double log_likelihood = -std::numeric_limits<double>::infinity();
    VectorXd found;
};

}  // namespace

double SmoothDeformation::probability() const {
    return 1 / (1 + std::exp(-log_evidence));
}

std::optional<SmoothDeformation> fit_smooth_deformation(const PointCloud& cloud, const SkinLut& lut,
                                                        const RigidTransform& ct_from_rig, int max_patches) {
    const std::vector<SkinPatch> patches = patches_of(cloud, lut, ct_from_rig, max_patches);
    constexpr std::size_t kFewest = 48;
    if (patches.size() < kFewest) return std::nullopt;
    const auto n = static_cast<Index>(patches.size());
    Vector3d centre = Vector3d::Zero();
    for (const SkinPatch& p : patches) centre += p.x_in_ct / static_cast<double>(n);
    const DeformableProblem problem(patches, centre, {});
    const Movements movements(patches, centre);
    // The columns: pose and offsets of the skin, which may be anything; then the modes along the normals.
    const Index free = kPose + problem.offsets.cols();
    MatrixXd X(n, free + kModes);
    X.leftCols(free) << problem.J, problem.offsets;
    for (Index i = 0; i < n; ++i)
        X.row(i).tail<kModes>() =
            patches[static_cast<std::size_t>(i)].normal.transpose() * movements.modes.middleRows<3>(3 * i);

    std::array<std::array<Solution, 1 + kTimes.size()>, kCorrelations_mm.size() * kOwnParts.size()> solved;
    tbb::parallel_for(std::size_t{0}, solved.size(), [&](std::size_t at) {
        MatrixXd K = problem.alike(kCorrelations_mm[at / kOwnParts.size()]);
        K.diagonal() += kOwnParts[at % kOwnParts.size()] * problem.own;
        const Eigen::LLT<MatrixXd> factor(K);
        if (factor.info() != Eigen::Success) return;
        const MatrixXd normal = X.transpose() * factor.solve(X);
        const VectorXd Kr = factor.solve(problem.residual_mm), taken = X.transpose() * Kr;
        const double squares = problem.residual_mm.dot(Kr),
                     log_K = 2 * factor.matrixLLT().diagonal().array().log().sum(),
                     freedom = static_cast<double>(n - free);
        // (The skin's variance is taken out by its own maximum: restricted likelihood.)
        const auto solve = [&](Index columns, double times) {
            MatrixXd given = normal.topLeftCorner(columns, columns);
            given.diagonal().tail(columns - free).array() += 1 / (times * times);
            const Eigen::LLT<MatrixXd> small(given);
            if (small.info() != Eigen::Success) return Solution{};
            Solution solution;
            solution.found = small.solve(taken.head(columns));
            const double variance = std::max(squares - taken.head(columns).dot(solution.found), 1e-12) / freedom;
            const double log_given = 2 * small.matrixLLT().diagonal().array().log().sum() +
                                     2 * static_cast<double>(columns - free) * std::log(times);
            solution.log_likelihood = -0.5 * (log_K + log_given + freedom * std::log(variance));
            return solution;
        };
        solved[at][0] = solve(free, 1);
        for (std::size_t t = 0; t < kTimes.size(); ++t) solved[at][1 + t] = solve(free + kModes, kTimes[t]);
    });
    Average without, with;
    for (const auto& of_skin : solved)
        for (std::size_t t = 0; t < of_skin.size(); ++t)
            (t == 0 ? without : with).add(of_skin[t].log_likelihood, of_skin[t].found);
    if (!(without.sum > 0) || !(with.sum > 0)) return std::nullopt;
    SmoothDeformation result;
    result.log_evidence = with.log_sum() - std::log(static_cast<double>(kTimes.size())) - without.log_sum();
    const VectorXd moved = movements.rigid * (with.pose / with.sum - without.pose / without.sum) +
                           movements.modes * (with.modes / with.sum);
    std::vector<double> moved_mm;
    for (Index i = 0; i < n; ++i) moved_mm.push_back(moved.segment<3>(3 * i).norm());
    result.p95_mm = quantile(std::move(moved_mm), 0.95);
    return result;
}

}  // namespace planlight
