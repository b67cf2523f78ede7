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
#include "registration/matching/gauss_newton.h"

namespace planlight {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// A scan point on the skin, or the mean of those of one place.
struct Patch {
    Vector3d x_in_ct = Vector3d::Zero(), normal = Vector3d::Zero();
    double distance_mm = 0;
    Vector3d turned = Vector3d::Zero();   ///< x cross normal, about the origin of ct
    Vector3d offsets = Vector3d::Zero();  ///< `offset_basis`
    double thickness_mm = 0;              ///< mean over the points for which it is known
    double known_thickness = 0;
};

/// How another threshold moves skin that faces along `normal`: by the width of its edge in the CT, which is that of the
/// voxels and differs between the scanner's axes (slices are thicker than pixels are wide). Beside the offset of the
/// whole, a part that goes with x^2 and one that goes with z^2; they look like a shift of a head seen from one side.
Vector3d offset_basis(const Vector3d& normal) {
    return {1, normal.x() * normal.x() - 1. / 3, normal.z() * normal.z() - 1. / 3};
}

/// The scan's points on real skin, each with its signed distance to the tangent plane of the table's nearest point:
/// the distance field is twice as coarse and cuts corners.
std::vector<Patch> points_on_skin(const PointCloud& cloud, const SkinLut& lut, const RigidTransform& ct_from_rig) {
    constexpr double kFar_mm = 6;
    std::vector<Patch> points;
    const std::size_t stride = std::max<std::size_t>(1, cloud.size() / 20000);
    for (std::size_t i = 0; i < cloud.size(); i += stride) {
        if (!cloud.points_in_rig[i].allFinite()) continue;
        Patch p;
        p.x_in_ct = ct_from_rig * cloud.points_in_rig[i];
        const SkinPoint* s = lut.nearest_skin(p.x_in_ct);
        if (!s || s->flags != kSkin) continue;
        p.normal = s->normal_in_ct.cast<double>();
        p.distance_mm = (p.x_in_ct - s->position_in_ct.cast<double>()).dot(p.normal);
        if (!(std::abs(p.distance_mm) < kFar_mm)) continue;
        p.turned = p.x_in_ct.cross(p.normal);
        p.offsets = offset_basis(p.normal);
        if (std::isfinite(s->thickness_mm)) p.thickness_mm = s->thickness_mm, p.known_thickness = 1;
        points.push_back(p);
    }
    return points;
}

/// The mean of the points that lie near their median distance: strays do not move it. All that the distance depends on
/// is averaged over the same points, so that a patch on bent skin is as true as its points.
Patch mean_of(const std::vector<const Patch*>& points) {
    constexpr double kNear_mm = 0.3, kSpreads = 4;
    std::vector<double> distances, off;
    for (const Patch* p : points) distances.push_back(p->distance_mm);
    const double middle = median(distances);
    for (const double d : distances) off.push_back(std::abs(d - middle));
    const double near_mm = std::max(kNear_mm, kSpreads * median(std::move(off)));
    Patch mean;
    double count = 0;
    for (const Patch* p : points) {
        if (std::abs(p->distance_mm - middle) > near_mm) continue;
        ++count;
        mean.x_in_ct += p->x_in_ct;
        mean.normal += p->normal;
        mean.distance_mm += p->distance_mm;
        mean.turned += p->turned;
        mean.offsets += p->offsets;
        mean.thickness_mm += p->thickness_mm;
        mean.known_thickness += p->known_thickness;
    }
    mean.x_in_ct /= count;
    mean.normal /= count;
    mean.distance_mm /= count;
    mean.turned /= count;
    mean.offsets /= count;
    if (mean.known_thickness > 0) mean.thickness_mm /= mean.known_thickness;
    return mean;
}

/// The scan in patches of about equal size, about `count` of them; those of fewer than a few points are left out.
std::vector<Patch> patches_of(const PointCloud& cloud, const SkinLut& lut, const RigidTransform& ct_from_rig,
                              int count) {
    const std::vector<Patch> points = points_on_skin(cloud, lut, ct_from_rig);
    const auto gathered = [&](double cell_mm) {
        std::map<std::array<int, 3>, std::vector<const Patch*>> cells;
        for (const Patch& p : points) {
            const Eigen::Vector3i cell = (p.x_in_ct / cell_mm).array().floor().cast<int>();
            cells[{cell.x(), cell.y(), cell.z()}].push_back(&p);
        }
        std::vector<Patch> patches;
        for (const auto& [cell, own] : cells)
            if (own.size() >= 4) patches.push_back(mean_of(own));
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
    Vector3d offset_mm = Vector3d::Zero();  ///< of the whole, and what `uneven` of the normal takes times the other two
    double scale = 1, scale_variance = 0;
};

/// How much of a patch's own it has: 1 near the skin, more the farther it lies off, so that what moved as a piece (a
/// jaw, a drape's edge) does not pull the pose. Scaled by the median, so that skin which moved by much is not left
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
    MatrixXd J;                ///< patches x 6
    Eigen::MatrixX3d offsets;  ///< patches x 3: `offset_basis`
    VectorXd residual_mm;
    VectorXd own;          ///< of each patch: more where it lies far off
    VectorXd growth_mm;    ///< of the distance, when the scan grows to twice its size
    MatrixXd squared_mm2;  ///< distances of patches
    VectorXd soft;         ///< how far each is likely to move, against the typical one

    Problem(const std::vector<Patch>& patches, const Vector3d& centre, const DeformableSettings& settings)
        : soft(softness(patches, settings.thickness_floor_mm)) {
        const auto n = static_cast<Eigen::Index>(patches.size());
        J.resize(n, 6);
        offsets.resize(n, 3);
        residual_mm.resize(n);
        squared_mm2.resize(n, n);
        growth_mm.resize(n);
        for (Eigen::Index i = 0; i < n; ++i) {
            const Patch& p = patches[static_cast<std::size_t>(i)];
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
    MatrixXd alike(double correlation_mm) const {
        return soft.asDiagonal() * (-squared_mm2.array() / (2 * correlation_mm * correlation_mm)).exp().matrix() *
               soft.asDiagonal();
    }
};

/// Generalised least squares of the pose and of an offset of the whole skin (another threshold, swelling all over),
/// which has a prior; how uneven it is over the directions has one as wide as the offset is large. A field smaller than
/// the least movement is not believed.
Plausible judge(const Problem& problem, const MatrixXd& alike, double own, const DeformableSettings& settings) {
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
    Plausible result;
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

double median_size(const VectorXd& values) {
    std::vector<double> sizes;
    for (const double v : values) sizes.push_back(std::abs(v));
    return median(std::move(sizes));
}

/// Whether the patches would lie much farther from the skin after the step than before it.
bool leaves_the_skin(const Problem& problem, const Vector6d& step, const Vector3d& offset_mm) {
    constexpr double kMuch = 2, kAlways_mm = 0.2;
    const VectorXd after_mm = problem.residual_mm + problem.J * step - problem.offsets.col(0) * offset_mm[0];
    return median_size(after_mm) > kMuch * median_size(problem.residual_mm) + kAlways_mm;
}

DeformablePose one_step(const PointCloud& cloud, const SkinLut& lut, const RigidTransform& ct_from_rig,
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
    Vector3d offset_mm = Vector3d::Zero();
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
    for (const Patch& p : points_on_skin(cloud, lut, ct_from_rig)) off.push_back(std::abs(p.distance_mm - offset_mm));
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
