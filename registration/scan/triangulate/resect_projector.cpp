#include "registration/scan/triangulate/resect_projector.h"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

namespace planlight {
namespace {

constexpr int kMaxIterations = 20;
constexpr double kHuber_px = 0.5;      // three times the usual residual: beyond it a point counts linearly
constexpr std::size_t kEnough = 8000;  // pairs: together they leave less than a hundredth of a pixel of noise

using Pair = Triangulation::ByCameras;
using Vector9d = Eigen::Matrix<double, 9, 1>;
using Matrix9d = Eigen::Matrix<double, 9, 9>;

std::vector<const Pair*> usable(const Triangulation& raw, const ResectionSettings& settings) {
    const std::size_t every = 1 + raw.by_cameras.size() / kEnough;
    std::vector<const Pair*> pairs;
    for (std::size_t i = 0; i < raw.by_cameras.size(); i += every)
        if (std::abs(raw.by_cameras[i].epipolar_px) <= settings.max_epipolar_px) pairs.push_back(&raw.by_cameras[i]);
    return pairs;
}

bool spread_enough(const std::vector<const Pair*>& pairs, const CameraModel& projector, double min_spread) {
    Eigen::Array2d sum = Eigen::Array2d::Zero(), squares = sum;
    for (const Pair* pair : pairs) {
        sum += pair->pixel_in_projector.array();
        squares += pair->pixel_in_projector.array().square();
    }
    const auto n = static_cast<double>(pairs.size());
    const Eigen::Array2d spread = (squares / n - (sum / n).square()).max(0).sqrt();
    return spread.minCoeff() >= min_spread * std::min(projector.width, projector.height);
}

struct Normal {
    Matrix9d A = Matrix9d::Zero();
    Vector9d b = Vector9d::Zero();
    double weighted_squares = 0, weights = 0;
};

/// Normal equations about `projector`: rotation and translation in its frame, principal point, logarithm of the focal
/// length.
Normal linearise_part(std::span<const Pair* const> pairs, const CameraModel& projector) {
    Normal normal;
    const Eigen::Matrix3d rig_from_device = projector.device_from_rig.linear().transpose();
    for (const Pair* pair : pairs) {
        Eigen::Matrix<double, 2, 3> by_point;
        const auto pixel = project(projector, pair->p_in_rig, by_point);
        if (!pixel) continue;
        const Eigen::Matrix<double, 2, 3> by_device = by_point * rig_from_device;
        const Eigen::Vector3d p = projector.device_from_rig * pair->p_in_rig;
        Eigen::Matrix<double, 2, 9> J;
        for (int k = 0; k < 3; ++k) J.col(k) = by_device * Eigen::Vector3d::Unit(k).cross(p);
        J.middleCols<3>(3) = by_device;
        J.middleCols<2>(6).setIdentity();
        J.col(8) = *pixel - Eigen::Vector2d(projector.centre_x, projector.centre_y);
        const Eigen::Vector2d r = pair->pixel_in_projector - *pixel;
        const double weight = std::min(1.0, kHuber_px / std::max(r.norm(), 1e-12));
        normal.A.noalias() += (weight * J.transpose()).lazyProduct(J);
        normal.b.noalias() += (weight * J.transpose()).lazyProduct(r);
        normal.weighted_squares += weight * r.squaredNorm();
        normal.weights += weight;
    }
    return normal;
}

/// The same in parts, added in their order: the sum does not depend on the threads.
Normal linearise(const std::vector<const Pair*>& pairs, const CameraModel& projector) {
    constexpr std::size_t kParts = 8;
    std::array<Normal, kParts> parts;
    tbb::parallel_for(std::size_t{0}, kParts, [&](std::size_t k) {
        const std::size_t begin = k * pairs.size() / kParts, end = (k + 1) * pairs.size() / kParts;
        parts[k] = linearise_part(std::span(pairs).subspan(begin, end - begin), projector);
    });
    Normal sum;
    for (const Normal& part : parts) {
        sum.A += part.A;
        sum.b += part.b;
        sum.weighted_squares += part.weighted_squares;
        sum.weights += part.weights;
    }
    return sum;
}

double rms_of(const Normal& normal) {
    return std::sqrt(normal.weighted_squares / std::max(2 * normal.weights, 1e-12));
}

CameraModel stepped(CameraModel projector, const Vector9d& step) {
    projector.device_from_rig = transform_from_twist(step.head<6>()) * projector.device_from_rig;
    projector.centre_x += step(6);
    projector.centre_y += step(7);
    projector.focal_x *= std::exp(step(8));
    projector.focal_y *= std::exp(step(8));
    return projector;
}

}  // namespace

std::optional<Resection> resect_projector(const Triangulation& raw, const RigCalibration& rig,
                                          const ResectionSettings& settings) {
    const auto pairs = usable(raw, settings);
    if (pairs.size() < settings.min_points || !spread_enough(pairs, rig.projector, settings.min_spread))
        return std::nullopt;
    const int free = settings.free_intrinsics ? 9 : 6;
    Resection result;
    result.projector = rig.projector;
    result.points = pairs.size();
    Normal normal = linearise(pairs, result.projector);
    result.rms_before_px = rms_of(normal);
    for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
        Vector9d step = Vector9d::Zero();
        const Eigen::VectorXd scale = normal.A.diagonal().head(free).cwiseSqrt().cwiseInverse();
        const Eigen::MatrixXd scaled = scale.asDiagonal() * normal.A.topLeftCorner(free, free) * scale.asDiagonal();
        step.head(free) = scale.asDiagonal() * scaled.ldlt().solve(scale.asDiagonal() * normal.b.head(free));
        if (!step.allFinite()) return std::nullopt;
        result.projector = stepped(result.projector, step);
        normal = linearise(pairs, result.projector);
        if (step.head<3>().norm() < 1e-8 && step.segment<3>(3).norm() < 1e-5) break;
    }
    result.rms_after_px = rms_of(normal);
    result.moved_mm = (result.projector.centre_in_rig() - rig.projector.centre_in_rig()).norm();
    result.turned = angle_between(result.projector.device_from_rig, rig.projector.device_from_rig);
    result.believable = result.rms_after_px <= settings.max_rms_after_px &&
                        result.rms_before_px - result.rms_after_px >= settings.min_gain_px &&
                        result.moved_mm <= settings.max_moved_mm && result.turned <= settings.max_turned;
    return result;
}

}  // namespace planlight
