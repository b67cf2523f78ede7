#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "registration/scan/decode/correspondence_map.h"
#include "registration/scan/triangulate/triangulate_parts.h"

namespace planlight {
namespace {

constexpr int kMaxIterations = 12;
constexpr double kMaxSigma_mm = 5;  // a worse point says nothing about where the skin is

/// Where a line of sight meets the plane of light of a column, distance along it: the plane through the projector and
/// two places of the column beside `row`. A lens bends the plane a little. Empty when they are parallel.
std::optional<double> depth_on_plane(const Ray& sight, double column, double row, const CameraModel& projector) {
    const double apart = 0.1 * projector.height;
    const auto above = ray_through(projector, {column, row - apart}),
               below = ray_through(projector, {column, row + apart});
    if (!above || !below) return std::nullopt;
    const Eigen::Vector3d normal = above->direction.cross(below->direction);
    const double towards = normal.dot(sight.direction);
    if (std::abs(towards) < 1e-6 * normal.norm()) return std::nullopt;
    return normal.dot(above->origin - sight.origin) / towards;
}

/// The distance along a line of sight at which the projector lights it with `column`; empty when there is none before
/// both devices. Newton's method from the plane of light: from elsewhere it need not arrive (from 850 mm it does not at
/// places nearer than 400).
std::optional<double> depth_of_column(const Ray& sight, double column, const CameraModel& projector) {
    auto t = depth_on_plane(sight, column, 0.5 * (projector.height - 1), projector);
    if (!t || !(*t > 0)) return std::nullopt;
    for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
        Eigen::Matrix<double, 2, 3> by_point;
        const auto pixel = project(projector, sight.origin + *t * sight.direction, by_point);
        if (!pixel) return std::nullopt;
        const double slope = by_point.row(0).dot(sight.direction);
        if (std::abs(slope) < 1e-4) return std::nullopt;  // the projector looks along the line of sight: no depth in it
        const double step = (column - pixel->x()) / slope;
        *t = std::max(*t + step, 0.5 * *t);
        if (std::abs(step) < 1e-6) return t;
    }
    return std::nullopt;
}

/// What one camera's code says about the depth along the other's line of sight.
struct Depth {
    double t = 0, sigma = 0;
};

/// The depth at which the right view shows `column` on the epipolar line, looked for around `start`.
std::optional<Depth> depth_from_right(const DecodedView& right, const CameraModel& camera, const Ray& sight,
                                      const Correspondence& left, double start, double camera_sigma_px) {
    double t = start;
    for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
        Eigen::Matrix<double, 2, 3> by_point;
        const auto pixel = project(camera, sight.origin + t * sight.direction, by_point);
        if (!pixel || !in_picture(camera, *pixel)) return std::nullopt;
        const int x = static_cast<int>(std::lround(pixel->x())), y = static_cast<int>(std::lround(pixel->y()));
        if (x < 0 || y < 0 || x >= right.width || y >= right.height) return std::nullopt;
        const auto local = correspondence_at(right, x, y);
        if (!local) return std::nullopt;
        const Eigen::RowVector2d by_pixel = local->by_pixel.row(0);
        const double code_here = local->code.x() + by_pixel.dot(*pixel - Eigen::Vector2d(x, y));
        const double slope = by_pixel * by_point * sight.direction;
        if (std::abs(slope) < 1e-4) return std::nullopt;
        const double step = (left.code.x() - code_here) / slope;
        if (std::abs(step) < 1e-4) {
            const double variance = left.sigma_px * left.sigma_px + local->sigma_px * local->sigma_px +
                                    by_pixel.squaredNorm() * 2 * camera_sigma_px * camera_sigma_px;
            return Depth{t, std::sqrt(variance) / std::abs(slope)};
        }
        t += std::clamp(step, -20.0, 20.0);
        if (std::abs(t - start) > 50) return std::nullopt;  // mm; another surface
    }
    return std::nullopt;
}

/// Depth from the projector's column and depth from the other camera are two measurements of one number: they must
/// agree, and their weighted mean is the point.
void place(const DecodedView& right, const Eigen::Vector2d& pixel, const Correspondence& local,
           const RigCalibration& rig, const TriangulationSettings& settings, PointOutcome& outcome) {
    outcome.kind = PointOutcome::Kind::no_partner;
    const auto sight = ray_through(rig.left_camera, pixel);
    if (!sight) return;
    const auto by_projector = depth_of_column(*sight, local.code.x(), rig.projector);
    if (!by_projector) return;
    const auto by_right =
        depth_from_right(right, rig.right_camera, *sight, local, *by_projector, settings.camera_sigma_px);
    if (!by_right) return;
    const Eigen::Vector3d p = sight->origin + by_right->t * sight->direction;
    Eigen::Matrix<double, 2, 3> by_point;
    const auto lit = project(rig.projector, p, by_point);
    if (!lit) return;
    outcome.placed_by_cameras = true;
    outcome.p_by_cameras = p;
    outcome.projector_offset_px = {local.code.x() - lit->x(), 0.0};
    const double sigma_px = std::hypot(settings.projector_sigma_px, settings.camera_sigma_px, local.sigma_px);
    const double projector_sigma = sigma_px / std::abs(by_point.row(0).dot(sight->direction));
    const double wp = 1 / (projector_sigma * projector_sigma), wr = 1 / (by_right->sigma * by_right->sigma);
    const double disagreement = std::abs(*by_projector - by_right->t) / std::hypot(projector_sigma, by_right->sigma);
    outcome.p_in_rig = sight->origin + (wp * *by_projector + wr * by_right->t) / (wp + wr) * sight->direction;
    outcome.sigma_mm = 1 / std::sqrt(wp + wr);
    const auto at = project(rig.projector, outcome.p_in_rig);
    if (disagreement > settings.max_residual_sigma || !at)
        outcome.kind = PointOutcome::Kind::disagree;
    else if (!in_volume(rig.projector, outcome.p_in_rig, settings))
        outcome.kind = PointOutcome::Kind::outside_volume;
    else
        outcome.kind = PointOutcome::Kind::point;
    if (at) outcome.pixel_in_projector = {local.code.x(), at->y()};
}

/// One camera: where its line of sight meets the plane of light of the column. Nothing checks it but that it meets the
/// plane on the projector's picture; near an edge blur shifts the code straight into depth.
void place_on_plane(const Eigen::Vector2d& pixel, const Correspondence& local, const RigCalibration& rig,
                    const TriangulationSettings& settings, PointOutcome& outcome) {
    constexpr double kRim_px = 3;
    outcome.kind = PointOutcome::Kind::ragged;
    if (!local.whole || local.code.x() < kRim_px || local.code.x() > rig.projector.width - 1 - kRim_px) return;
    outcome.kind = PointOutcome::Kind::disagree;
    const auto sight = ray_through(rig.left_camera, pixel);
    if (!sight) return;
    const auto depth = depth_of_column(*sight, local.code.x(), rig.projector);
    if (!depth) return;
    outcome.p_in_rig = sight->origin + *depth * sight->direction;
    Eigen::Matrix<double, 2, 3> by_point;
    const auto lit = project(rig.projector, outcome.p_in_rig, by_point);
    if (!lit || lit->y() < -kRim_px || lit->y() > rig.projector.height - 1 + kRim_px) return;
    const double sigma_px = std::hypot(settings.projector_sigma_px, settings.camera_sigma_px, local.sigma_px);
    outcome.sigma_mm = sigma_px / std::abs(by_point.row(0).dot(sight->direction));
    outcome.pixel_in_projector = {local.code.x(), lit->y()};
    outcome.seen = Triangulation::Seen::left_only;
    if (!(outcome.sigma_mm < kMaxSigma_mm)) return;
    outcome.kind = in_volume(rig.projector, outcome.p_in_rig, settings) ? PointOutcome::Kind::point
                                                                        : PointOutcome::Kind::outside_volume;
}

}  // namespace

Triangulation triangulate_columns(const DecodedView& left, const DecodedView& right, const RigCalibration& rig,
                                  const TriangulationSettings& settings) {
    Triangulation result;
    const bool one_camera = right.column.size() <= 1;
    if (one_camera && !settings.one_camera) return result;
    result.stride = stride_for(left.decoded, settings);
    const auto [step_x, step_y] = result.stride;
    const int columns = (left.width + step_x - 1) / step_x, rows = (left.height + step_y - 1) / step_y;
    std::vector<PointOutcome> outcomes(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
    tbb::parallel_for(0, rows, [&](int r) {
        for (int c = 0; c < columns; ++c) {
            PointOutcome& outcome =
                outcomes[static_cast<std::size_t>(r) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(c)];
            const int x = c * step_x, y = r * step_y;
            const float code = left.column[static_cast<std::size_t>(y) * static_cast<std::size_t>(left.width) +
                                           static_cast<std::size_t>(x)];
            if (std::isnan(code)) continue;
            outcome.kind = PointOutcome::Kind::ragged;
            const auto local = correspondence_at(left, x, y);
            if (local && one_camera)
                place_on_plane(Eigen::Vector2d(x, y), *local, rig, settings, outcome);
            else if (local)
                place(right, Eigen::Vector2d(x, y), *local, rig, settings, outcome);
        }
    });
    collect(outcomes, result);
    return result;
}

}  // namespace planlight
