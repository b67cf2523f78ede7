#include "registration/scan/triangulate/triangulate_cameras.h"

#include <tbb/parallel_for.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "planning_io/types/between_rays.h"
#include "registration/scan/decode/correspondence_map.h"
#include "registration/scan/triangulate/triangulate_parts.h"

namespace planlight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kMaxSigma_mm = 5;

/// Right pixels by their column's code, with where they look: the partner of a left pixel lies on its epipolar line.
class ColumnIndex {
public:
    ColumnIndex(const DecodedView& view, const CameraModel& camera, int projector_width)
        : focal_(camera.focal_x), pixels_(static_cast<std::size_t>(std::max(1, projector_width))) {
        std::vector<Seen> seen(view.column.size());
        tbb::parallel_for(0, view.height, [&](int y) {
            for (int x = 0; x < view.width; ++x) {
                const std::size_t i = index(view, x, y);
                if (std::isnan(view.column[i])) continue;
                if (const auto n = undistort(camera, Vector2d(x, y))) seen[i] = {x, y, n->cast<float>()};
            }
        });
        for (std::size_t i = 0; i < seen.size(); ++i) {
            const long column = seen[i].x < 0 ? -1 : std::lround(view.column[i]);
            if (column >= 0 && column < static_cast<long>(pixels_.size()))
                pixels_[static_cast<std::size_t>(column)].push_back(seen[i]);
        }
    }
    /// The pixel of this code (or one beside it) nearest to a line a x + b y + c = 0 of normalised coordinates.
    std::optional<Vector2d> nearest(double code, const Vector3d& line) const {
        constexpr double kReach_px = 1.5;
        const double scale = focal_ / line.head<2>().norm();
        double best = kReach_px;
        std::optional<Vector2d> found;
        const long middle = std::lround(code);
        for (long column = middle - 1; column <= middle + 1; ++column) {
            if (column < 0 || column >= static_cast<long>(pixels_.size())) continue;
            for (const Seen& s : pixels_[static_cast<std::size_t>(column)]) {
                const double off =
                    std::abs(line.x() * s.normalised.x() + line.y() * s.normalised.y() + line.z()) * scale +
                    0.25 * static_cast<double>(std::abs(column - middle));
                if (off >= best) continue;
                best = off;
                found = Vector2d(s.x, s.y);
            }
        }
        return found;
    }

private:
    struct Seen {
        int x = -1, y = -1;
        Eigen::Vector2f normalised{0, 0};
    };
    static std::size_t index(const DecodedView& view, int x, int y) {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width) + static_cast<std::size_t>(x);
    }
    double focal_;
    std::vector<std::vector<Seen>> pixels_;
};

/// The epipolar line of a line of sight in a camera's normalised coordinates.
Vector3d epipolar_line(const Ray& sight, const CameraModel& camera) {
    const Vector3d origin = camera.device_from_rig * sight.origin,
                   way = camera.device_from_rig.linear() * sight.direction;
    return origin.cross(way);
}

/// Along the line of sight to where the right view shows `column` (Newton). The covariance is that of the depth alone.
void place_on_sight(const DecodedView& right, const RigCalibration& rig, const Ray& sight, const Correspondence& local,
                    const Vector3d& start, const TriangulationSettings& settings, PointOutcome& outcome) {
    outcome.kind = PointOutcome::Kind::ragged;
    double t = (start - sight.origin).dot(sight.direction);
    for (int iteration = 0; iteration < 8; ++iteration) {
        Eigen::Matrix<double, 2, 3> by_point;
        const auto pixel = project(rig.right_camera, sight.origin + t * sight.direction, by_point);
        if (!pixel || !in_picture(rig.right_camera, *pixel)) return;
        const int x = static_cast<int>(std::lround(pixel->x())), y = static_cast<int>(std::lround(pixel->y()));
        if (x < 0 || y < 0 || x >= right.width || y >= right.height) return;
        const auto other = correspondence_at(right, x, y);
        if (!other) return;
        const Eigen::RowVector2d by_pixel = other->by_pixel.row(0);
        const double slope = by_pixel * by_point * sight.direction;
        if (std::abs(slope) < 1e-4) return;
        const double step = (local.code.x() - other->code.x() - by_pixel.dot(*pixel - Vector2d(x, y))) / slope;
        t += std::clamp(step, -20.0, 20.0);
        if (!(t > 0)) return;
        if (std::abs(step) > 1e-3) continue;
        const double variance = local.sigma_px * local.sigma_px + other->sigma_px * other->sigma_px +
                                by_pixel.squaredNorm() * 2 * settings.camera_sigma_px * settings.camera_sigma_px;
        outcome.p_in_rig = sight.origin + t * sight.direction;
        outcome.sigma_mm = std::sqrt(variance) / std::abs(slope);
        outcome.kind = PointOutcome::Kind::point;
        return;
    }
}

struct Pixels {
    Vector2d left, right;
    double right_sigma_px;  ///< the left's is the settings'
};

/// The point of least reprojection in both cameras, and what is left of it (in sigmas).
void place_by_both(const Pixels& seen, const RigCalibration& rig, const Vector3d& start,
                   const TriangulationSettings& settings, PointOutcome& outcome) {
    outcome.kind = PointOutcome::Kind::disagree;
    Vector3d p = start;
    for (int iteration = 0; iteration < 6; ++iteration) {
        Eigen::Matrix<double, 4, 3> J;
        Eigen::Vector4d r;
        Eigen::Matrix<double, 2, 3> by_point;
        const auto left = project(rig.left_camera, p, by_point);
        if (!left) return;
        r.head<2>() = (seen.left - *left) / settings.camera_sigma_px;
        J.topRows<2>() = by_point / settings.camera_sigma_px;
        const auto right = project(rig.right_camera, p, by_point);
        if (!right) return;
        r.tail<2>() = (seen.right - *right) / seen.right_sigma_px;
        J.bottomRows<2>() = by_point / seen.right_sigma_px;
        const Eigen::Matrix3d covariance = (J.transpose() * J).inverse();
        const Vector3d step = covariance * (J.transpose() * r);
        if (!step.allFinite()) return;
        p += step;
        if (step.squaredNorm() > 1e-10) continue;
        if ((r - J * step).norm() > settings.max_residual_sigma) return;
        outcome.p_in_rig = p;
        outcome.sigma_mm = worst_sigma(covariance);
        outcome.kind = PointOutcome::Kind::point;
        return;
    }
}

/// What remains of the right pixel's difference across the epipolar line, right pixels.
double off_the_line(const Ray& sight, const Vector3d& p, const Vector2d& pixel, const CameraModel& camera) {
    Eigen::Matrix<double, 2, 3> by_point;
    const auto expected =
        project(camera, sight.origin + (p - sight.origin).dot(sight.direction) * sight.direction, by_point);
    if (!expected) return 0;
    const Vector2d along = (by_point * sight.direction).normalized(), d = pixel - *expected;
    return along.x() * d.y() - along.y() * d.x();
}

/// Whether the columns' code changes along a picture's lines, and not across them (a camera on its side).
bool changes_along_lines(const DecodedView& view) {
    double along = 0, across = 0;
    for (int y = 0; y + 1 < view.height; ++y)
        for (int x = 0; x + 1 < view.width; x += 3) {
            const std::size_t i =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width) + static_cast<std::size_t>(x);
            const double to_right = std::abs(view.column[i + 1] - view.column[i]),
                         down = std::abs(view.column[i + static_cast<std::size_t>(view.width)] - view.column[i]);
            constexpr double kJump_px = 8;
            if (!(to_right + down < kJump_px)) continue;  // NaN as well
            along += to_right;
            across += down;
        }
    return along >= across;
}

/// One left pixel. Either index is empty where the other is used.
struct Matcher {
    const DecodedView &left, &right;
    const RigCalibration& rig;
    const TriangulationSettings& settings;
    const CorrespondenceIndex* by_code;
    const ColumnIndex* by_column;
    bool along_lines;  ///< see changes_along_lines

    void place(int x, int y, PointOutcome& outcome) const {
        using Kind = PointOutcome::Kind;
        outcome.kind = Kind::ragged;
        const auto local = correspondence_at(left, x, y);
        if (!local) return;
        outcome.pixel_in_projector = local->code;
        outcome.kind = Kind::no_partner;
        const auto sight = ray_through(rig.left_camera, Vector2d(x, y));
        if (!sight) return;
        if (by_code)
            both_directions(Vector2d(x, y), *sight, *local, outcome);
        else
            columns_only(*sight, *local, outcome, along_lines ? y : x);
        if (outcome.kind != Kind::point) return;
        if (!(outcome.sigma_mm < kMaxSigma_mm))
            outcome.kind = Kind::disagree;
        else if (!in_volume(rig.left_camera, outcome.p_in_rig, settings))
            outcome.kind = Kind::outside_volume;
    }
    void both_directions(const Vector2d& pixel, const Ray& sight, const Correspondence& local,
                         PointOutcome& outcome) const {
        CorrespondenceIndex::Match match;
        if (!by_code->find(local.code, match)) return;
        outcome.kind = PointOutcome::Kind::disagree;
        const auto other = ray_through(rig.right_camera, match.pixel);
        const auto start = other ? between_rays(sight, *other) : std::nullopt;
        if (!start) return;
        outcome.placed_by_cameras = true;
        outcome.p_by_cameras = *start;
        outcome.epipolar_px = off_the_line(sight, *start, match.pixel, rig.right_camera);
        const double code_sigma = std::hypot(local.sigma_px, match.local.sigma_px);
        const double by_code_px = match.local.by_pixel.inverse().norm() / std::sqrt(2.0);
        place_by_both({pixel, match.pixel, std::hypot(settings.camera_sigma_px, by_code_px * code_sigma)}, rig, *start,
                      settings, outcome);
    }
    void columns_only(const Ray& sight, const Correspondence& local, PointOutcome& outcome, int across) const {
        outcome.pixel_in_projector.y() = across;  // the grid of neighbours: the picture's own lines
        const auto near = by_column->nearest(local.code.x(), epipolar_line(sight, rig.right_camera));
        const auto other = near ? ray_through(rig.right_camera, *near) : std::nullopt;
        const auto start = other ? between_rays(sight, *other) : std::nullopt;
        if (start) place_on_sight(right, rig, sight, local, *start, settings, outcome);
    }
};

}  // namespace

Triangulation triangulate_cameras(const DecodedView& left, const DecodedView& right, const RigCalibration& rig,
                                  int projector_width, int projector_height, const TriangulationSettings& settings) {
    if (left.row.empty() != right.row.empty())
        throw std::invalid_argument("triangulate_cameras: one view codes the rows, the other does not");
    Triangulation result;
    result.stride = stride_for(left.decoded, settings);
    std::optional<CorrespondenceIndex> by_code;
    std::optional<ColumnIndex> by_column;
    if (left.row.empty())
        by_column.emplace(right, rig.right_camera, projector_width);
    else
        by_code.emplace(right, projector_width, projector_height);
    const Matcher matcher{left,
                          right,
                          rig,
                          settings,
                          by_code ? &*by_code : nullptr,
                          by_column ? &*by_column : nullptr,
                          by_column && changes_along_lines(left)};
    const auto [step_x, step_y] = result.stride;
    const int columns = (left.width + step_x - 1) / step_x, rows = (left.height + step_y - 1) / step_y;
    std::vector<PointOutcome> outcomes(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
    tbb::parallel_for(0, rows, [&](int r) {
        for (int c = 0; c < columns; ++c) {
            const int x = c * step_x, y = r * step_y;
            if (!std::isnan(left.column[static_cast<std::size_t>(y) * static_cast<std::size_t>(left.width) +
                                        static_cast<std::size_t>(x)]))
                matcher.place(x, y,
                              outcomes[static_cast<std::size_t>(r) * static_cast<std::size_t>(columns) +
                                       static_cast<std::size_t>(c)]);
        }
    });
    collect(outcomes, result);
    return result;
}

}  // namespace planlight
