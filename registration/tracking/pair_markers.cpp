#include "registration/tracking/pair_markers.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "planning_io/types/between_rays.h"

namespace planlight {
namespace {

constexpr double kPairSigmaPx = 0.3;    // calibration and measurement, for the choice between pairs
constexpr double kSizeSigma = 0.04;     // of the logarithm of the disc's size
constexpr double kMaxSizeError = 0.25;  // printing, skin that bends the sticker, blur

/// Logarithm of (disc size as seen / true size). A tilted disc keeps its large axis.
double size_error(const CameraModel& camera, const MarkerObservation& seen, const Eigen::Vector3d& point_in_rig,
                  const MarkerDesign& design) {
    const double large_axis_px = 2 * seen.radius_px / (1 + seen.axis_ratio);
    const double depth_mm = (camera.device_from_rig * point_in_rig).z();
    return std::log(2 * large_axis_px * depth_mm / (0.5 * (camera.focal_x + camera.focal_y)) / design.disc_diameter_mm);
}

/// The assignment of rows to columns of least total cost; rows <= columns (Hungarian method with potentials).
std::vector<int> cheapest_assignment(const Eigen::MatrixXd& cost) {
    const int n = static_cast<int>(cost.rows()), m = static_cast<int>(cost.cols());
    const auto size = static_cast<std::size_t>(m + 1);
    std::vector<double> row_potential(static_cast<std::size_t>(n + 1), 0), column_potential(size, 0);
    std::vector<int> row_of(size, 0), way(size, 0);
    for (int row = 1; row <= n; ++row) {
        row_of[0] = row;
        std::size_t column = 0;
        std::vector<double> least(size, std::numeric_limits<double>::infinity());
        std::vector<bool> done(size, false);
        do {
            done[column] = true;
            const int r = row_of[column];
            std::size_t next = 0;
            double delta = std::numeric_limits<double>::infinity();
            for (std::size_t j = 1; j < size; ++j) {
                if (done[j]) continue;
                const double reduced = cost(r - 1, static_cast<int>(j) - 1) -
                                       row_potential[static_cast<std::size_t>(r)] - column_potential[j];
                if (reduced < least[j]) least[j] = reduced, way[j] = static_cast<int>(column);
                if (least[j] < delta) delta = least[j], next = j;
            }
            for (std::size_t j = 0; j < size; ++j) {
                if (done[j])
                    row_potential[static_cast<std::size_t>(row_of[j])] += delta, column_potential[j] -= delta;
                else
                    least[j] -= delta;
            }
            column = next;
        } while (row_of[column] != 0);
        while (column != 0) {
            const auto before = static_cast<std::size_t>(way[column]);
            row_of[column] = row_of[before];
            column = before;
        }
    }
    std::vector<int> column_of(static_cast<std::size_t>(n), -1);
    for (std::size_t j = 1; j < size; ++j)
        if (row_of[j] > 0) column_of[static_cast<std::size_t>(row_of[j] - 1)] = static_cast<int>(j) - 1;
    return column_of;
}

}  // namespace

std::optional<TriangulatedMarker> triangulate_marker(const RigCalibration& rig, const MarkerObservation& left,
                                                     const MarkerObservation& right) {
    const auto a = ray_through(rig.left_camera, left.pixel), b = ray_through(rig.right_camera, right.pixel);
    if (!a || !b) return std::nullopt;
    const auto start = between_rays(*a, *b);
    if (!start) return std::nullopt;
    TriangulatedMarker result{*start};
    for (int iteration = 0; iteration < 4; ++iteration) {
        Eigen::Matrix3d N = Eigen::Matrix3d::Zero();
        Eigen::Vector3d g = Eigen::Vector3d::Zero();
        result.largest_residual_px = 0;
        const auto add = [&](const CameraModel& camera, const MarkerObservation& seen) {
            Eigen::Matrix<double, 2, 3> J;
            const auto pixel = project(camera, result.point_in_rig, J);
            if (!pixel) return false;
            const Eigen::Vector2d error = seen.pixel - *pixel;
            const double weight = 1 / std::max(1e-4, seen.sigma_px * seen.sigma_px);
            N += weight * J.transpose() * J;
            g += weight * J.transpose() * error;
            result.largest_residual_px = std::max(result.largest_residual_px, error.norm());
            return true;
        };
        if (!add(rig.left_camera, left) || !add(rig.right_camera, right)) return std::nullopt;
        const Eigen::Matrix3d covariance = N.inverse();
        if (!covariance.allFinite()) return std::nullopt;
        result.sigma_mm = std::sqrt(covariance.trace() / 3);
        const Eigen::Vector3d step = covariance * g;
        if (step.norm() < 1e-6) break;
        result.point_in_rig += step;
    }
    return result;
}

std::vector<MarkerPair> possible_pairs(const RigCalibration& rig, const std::vector<MarkerObservation>& left,
                                       const std::vector<MarkerObservation>& right, const MarkerDesign& design,
                                       double max_epipolar_px) {
    std::vector<MarkerPair> pairs;
    for (std::size_t i = 0; i < left.size(); ++i) {
        for (std::size_t j = 0; j < right.size(); ++j) {
            const auto marker = triangulate_marker(rig, left[i], right[j]);
            if (!marker || marker->largest_residual_px > max_epipolar_px) continue;
            const double size_left = size_error(rig.left_camera, left[i], marker->point_in_rig, design);
            const double size_right = size_error(rig.right_camera, right[j], marker->point_in_rig, design);
            if (!(std::abs(size_left) < kMaxSizeError && std::abs(size_right) < kMaxSizeError)) continue;
            const double cost = 2 * std::pow(marker->largest_residual_px / kPairSigmaPx, 2) +
                                std::pow(size_left / kSizeSigma, 2) + std::pow(size_right / kSizeSigma, 2);
            pairs.push_back({static_cast<int>(i), static_cast<int>(j), marker->point_in_rig, marker->sigma_mm, cost});
        }
    }
    return pairs;
}

std::vector<MarkerPair> consistent_pairs(const std::vector<MarkerPair>& possible, int left_count, int right_count) {
    constexpr double kImpossible = 1e6, kAlone = 1e4, kMargin = 9;
    if (left_count == 0 || right_count == 0) return {};
    // Every left disc may also stay alone: one more column each.
    Eigen::MatrixXd cost = Eigen::MatrixXd::Constant(left_count, right_count + left_count, kImpossible);
    cost.rightCols(left_count).setConstant(kAlone);
    for (const MarkerPair& p : possible) cost(p.left, p.right) = p.cost;
    const std::vector<int> right_of = cheapest_assignment(cost);
    const auto chosen = [&](const MarkerPair& p) { return right_of[static_cast<std::size_t>(p.left)] == p.right; };
    const auto ambiguous = [&](const MarkerPair& p) {
        for (int other = 0; other < left_count; ++other) {
            const int right = right_of[static_cast<std::size_t>(other)];
            if (other == p.left || right >= right_count) continue;
            if (cost(p.left, right) + cost(other, p.right) < cost(p.left, p.right) + cost(other, right) + kMargin)
                return true;
        }
        return false;
    };
    std::vector<MarkerPair> pairs;
    for (const MarkerPair& p : possible)
        if (chosen(p) && !ambiguous(p)) pairs.push_back(p);
    return pairs;
}

}  // namespace planlight
