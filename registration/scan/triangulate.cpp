#include "registration/scan/triangulate.h"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "registration/scan/code_map.h"
#include "registration/scan/triangulate_parts.h"

namespace planlight {
namespace {

constexpr int kMaxIterations = 6;
constexpr double kMaxSigma_mm = 5;  // a worse point says nothing about where the skin is

/// Up to three views of one point: pixels, and the covariance of all their coordinates together.
template <int Rows>
struct Views {
    std::array<const CameraModel*, Rows / 2> device;
    Eigen::Matrix<double, Rows, 1> pixels;
    Eigen::Matrix<double, Rows, Rows> covariance;
};

struct Estimate {
    Eigen::Vector3d p_in_rig;
    Eigen::Matrix3d covariance;
    double residual_sigma = 0;  ///< root of the weighted sum of squared residuals
};

/// Least squares over all views (Gauss-Newton), weighted by their covariance.
template <int Rows>
std::optional<Estimate> adjust(const Views<Rows>& views, Eigen::Vector3d p) {
    const Eigen::LLT<Eigen::Matrix<double, Rows, Rows>> whiten(views.covariance);
    Eigen::Matrix<double, Rows, 1> r;
    Eigen::Matrix<double, Rows, 3> J;
    for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
        for (int k = 0; k < Rows / 2; ++k) {
            Eigen::Matrix<double, 2, 3> by_point;
            const auto pixel = project(*views.device[static_cast<std::size_t>(k)], p, by_point);
            if (!pixel) return std::nullopt;
            r.template segment<2>(2 * k) = views.pixels.template segment<2>(2 * k) - *pixel;
            J.template middleRows<2>(2 * k) = by_point;
        }
        whiten.matrixL().solveInPlace(r);
        whiten.matrixL().solveInPlace(J);
        const Eigen::Matrix3d normal = J.transpose() * J;
        const Eigen::Matrix3d covariance = normal.inverse();
        const Eigen::Vector3d step = covariance * (J.transpose() * r);
        if (!step.allFinite()) return std::nullopt;
        p += step;
        if (step.squaredNorm() < 1e-10) return Estimate{p, covariance, (r - J * step).norm()};
    }
    return std::nullopt;
}

Eigen::Matrix2d square_of(double sigma) { return Eigen::Matrix2d::Identity() * sigma * sigma; }

/// Distance of the right pixel from the epipolar line of the left one, in right pixels: what remains of the difference
/// to the projected midpoint across the direction in which depth moves it.
double epipolar_distance(const CameraModel& right, const Ray& left_ray, const Eigen::Vector3d& p, const Eigen::Vector2d& pixel) {
    const double depth = (p - left_ray.origin).dot(left_ray.direction);
    Eigen::Matrix<double, 2, 3> by_point;
    const auto expected = project(right, left_ray.origin + depth * left_ray.direction, by_point);
    if (!expected) return 0;
    const Eigen::Vector2d along = (by_point * left_ray.direction).normalized(), d = pixel - *expected;
    return along.x() * d.y() - along.y() * d.x();
}

void judge(const std::optional<Estimate>& estimate, const RigCalibration& rig, const TriangulationSettings& settings,
           PointOutcome& outcome) {
    using Kind = PointOutcome::Kind;
    if (!estimate || estimate->residual_sigma > settings.max_residual_sigma) {
        outcome.kind = Kind::disagree;
        return;
    }
    outcome.p_in_rig = estimate->p_in_rig;
    outcome.sigma_mm = worst_sigma(estimate->covariance);
    if (!in_volume(rig.projector, outcome.p_in_rig, settings)) outcome.kind = Kind::outside_volume;
    else outcome.kind = outcome.sigma_mm < kMaxSigma_mm ? Kind::point : Kind::disagree;
}

/// At an edge of an object, a shadow or the projector's picture, blur mixes light with darkness and shifts the code.
/// Two cameras see the same shift and agree on the place; with one camera it would go straight into depth.
bool near_an_edge(const LocalCode& local, const CameraModel& projector) {
    constexpr double kRim_px = 3;
    const Eigen::Vector2d last(projector.width - 1, projector.height - 1);
    return !local.whole || local.code.minCoeff() < kRim_px || (last - local.code).minCoeff() < kRim_px;
}

/// A pixel that one camera and the projector share.
void two_views(const CameraModel& camera, const Eigen::Vector2d& pixel, const LocalCode& local, const RigCalibration& rig,
               const TriangulationSettings& settings, PointOutcome& outcome) {
    outcome.kind = PointOutcome::Kind::ragged;
    if (near_an_edge(local, rig.projector)) return;
    outcome.kind = PointOutcome::Kind::disagree;
    const auto sight = ray_through(camera, pixel), light = ray_through(rig.projector, local.code);
    if (!sight || !light) return;
    const auto start = between_rays(*sight, *light);
    if (!start) return;
    Views<4> views;
    views.device = {&camera, &rig.projector};
    views.pixels << pixel, local.code;
    views.covariance.setZero();
    views.covariance.topLeftCorner<2, 2>() = square_of(settings.camera_sigma_px);
    views.covariance.bottomRightCorner<2, 2>() = square_of(settings.projector_sigma_px) + square_of(local.sigma_px);
    judge(adjust(views, *start), rig, settings, outcome);
}

/// A left pixel whose code the right camera sees as well. The right pixel is where the right view's code equals the
/// left's, so the noise of the left code moves both it and the projector pixel: their covariance is not zero.
void three_views(const Eigen::Vector2d& left_pixel, const LocalCode& left, const CodeIndex::Match& right,
                 const RigCalibration& rig, const TriangulationSettings& settings, PointOutcome& outcome) {
    outcome.kind = PointOutcome::Kind::disagree;
    const auto sight = ray_through(rig.left_camera, left_pixel), other = ray_through(rig.right_camera, right.pixel);
    if (!sight || !other) return;
    const auto start = between_rays(*sight, *other);
    if (!start) return;
    if (const auto expected = project(rig.projector, *start)) {
        outcome.placed_by_cameras = true;
        outcome.projector_offset_px = left.code - *expected;
        outcome.p_by_cameras = *start;
        outcome.epipolar_px = epipolar_distance(rig.right_camera, *sight, *start, right.pixel);
    }
    const Eigen::Matrix2d pixel_by_code = right.local.by_pixel.inverse();
    Views<6> views;
    views.device = {&rig.left_camera, &rig.right_camera, &rig.projector};
    views.pixels << left_pixel, right.pixel, left.code;
    views.covariance.setZero();
    views.covariance.block<2, 2>(0, 0) = square_of(settings.camera_sigma_px);
    views.covariance.block<2, 2>(2, 2) =
        square_of(settings.camera_sigma_px) +
        pixel_by_code * (square_of(left.sigma_px) + square_of(right.local.sigma_px)) * pixel_by_code.transpose();
    views.covariance.block<2, 2>(4, 4) = square_of(settings.projector_sigma_px) + square_of(left.sigma_px);
    views.covariance.block<2, 2>(2, 4) = pixel_by_code * square_of(left.sigma_px);
    views.covariance.block<2, 2>(4, 2) = views.covariance.block<2, 2>(2, 4).transpose();
    judge(adjust(views, *start), rig, settings, outcome);
}

/// Calls `make(x, y, outcome)` for every `stride`-th pixel of a view, in parallel; the order of the result is that of
/// the pixels, whatever the threads do.
template <class Make>
std::vector<PointOutcome> for_pixels(const DecodedView& view, int stride, const Make& make) {
    const int columns = (view.width + stride - 1) / stride, rows = (view.height + stride - 1) / stride;
    std::vector<PointOutcome> outcomes(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
    tbb::parallel_for(0, rows, [&](int r) {
        for (int c = 0; c < columns; ++c) {
            const int x = c * stride, y = r * stride;
            if (std::isnan(view.column[static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width) +
                                       static_cast<std::size_t>(x)]))
                continue;
            make(x, y, outcomes[static_cast<std::size_t>(r) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(c)]);
        }
    });
    return outcomes;
}

}  // namespace

Triangulation triangulate(const DecodedView& left, const DecodedView& right, const RigCalibration& rig,
                          const TriangulationSettings& settings) {
    if (left.row.empty() != right.row.empty())
        throw std::invalid_argument("triangulate: one view codes the rows, the other does not");
    for (const DecodedView* view : {&left, &right}) {
        const std::size_t pixels = static_cast<std::size_t>(view->width) * static_cast<std::size_t>(view->height);
        if (view->column.size() != pixels || view->sigma_px.size() != pixels ||
            (!view->row.empty() && view->row.size() != pixels))
            throw std::invalid_argument("triangulate: the arrays of a view do not have its size");
    }
    if (rig.projector.width < 1 || rig.projector.height < 1)
        throw std::invalid_argument("triangulate: the projector has no size");
    if (left.row.empty()) return triangulate_columns(left, right, rig, settings);

    using Kind = PointOutcome::Kind;
    using Seen = Triangulation::Seen;
    Triangulation result;
    result.stride = stride_for(std::max(left.decoded, right.decoded), settings);
    const CodeIndex in_left(left, rig.projector.width, rig.projector.height);
    const CodeIndex in_right(right, rig.projector.width, rig.projector.height);
    collect(for_pixels(left, result.stride, [&](int x, int y, PointOutcome& outcome) {
        const auto local = local_code(left, x, y);
        outcome.kind = Kind::ragged;
        if (!local) return;
        outcome.pixel_in_projector = local->code;
        const Eigen::Vector2d pixel(x, y);
        if (const auto match = in_right.find(local->code)) return three_views(pixel, *local, *match, rig, settings, outcome);
        outcome.kind = Kind::no_partner;
        outcome.seen = Seen::left_only;
        if (settings.one_camera) two_views(rig.left_camera, pixel, *local, rig, settings, outcome);
    }), result);
    if (!settings.one_camera) return result;
    collect(for_pixels(right, result.stride, [&](int x, int y, PointOutcome& outcome) {
        const auto local = local_code(right, x, y);
        if (!local || in_left.find(local->code)) return;  // ragged pixels were counted in the left view
        outcome.pixel_in_projector = local->code;
        outcome.seen = Seen::right_only;
        two_views(rig.right_camera, Eigen::Vector2d(x, y), *local, rig, settings, outcome);
    }), result);
    return result;
}

}  // namespace planlight
