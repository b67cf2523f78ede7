#include "registration/calibration/bent_residuals.h"
#include "planning_io/types/statistics.h"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace planlight {
namespace {

constexpr std::size_t kSide = 10, kLeastPoints = 30, kLeastPlaces = 40;
constexpr double kWild_px = 2;  // beyond it a point has another partner, not another lens

/// One value of each kind a point: its place in a picture first.
template <std::size_t N>
using Rows = std::vector<std::array<double, N>>;

/// The borders of kSide classes of equally many values.
template <std::size_t N>
std::array<double, kSide - 1> borders(const Rows<N>& rows, std::size_t which) {
    std::vector<double> values;
    for (const auto& row : rows) values.push_back(row[which]);
    std::sort(values.begin(), values.end());
    std::array<double, kSide - 1> borders;
    for (std::size_t k = 1; k < kSide; ++k) borders[k - 1] = values[k * values.size() / kSide];
    return borders;
}

/// The medians of all values over each place with enough points.
template <std::size_t N>
Rows<N> medians(const Rows<N>& rows) {
    if (rows.empty()) return {};
    const auto in_x = borders(rows, 0), in_y = borders(rows, 1);
    std::vector<Rows<N>> places(kSide * kSide);
    const auto class_of = [](const auto& limits, double v) {
        return static_cast<std::size_t>(std::upper_bound(limits.begin(), limits.end(), v) - limits.begin());
    };
    for (const auto& row : rows) places[class_of(in_y, row[1]) * kSide + class_of(in_x, row[0])].push_back(row);
    Rows<N> found;
    std::vector<double> values;
    for (const Rows<N>& place : places) {
        if (place.size() < kLeastPoints) continue;
        std::array<double, N> middle;
        for (std::size_t k = 0; k < N; ++k) {
            values.clear();
            for (const auto& row : place) values.push_back(row[k]);
            const auto half = median(values);
            middle[k] = half;
        }
        found.push_back(middle);
    }
    return found;
}

/// Normalised coordinates of a point in a device; z is its depth.
Eigen::Vector3d normalised(const CameraModel& device, const Eigen::Vector3d& p_in_rig) {
    const Eigen::Vector3d p = device.device_from_rig * p_in_rig;
    return {p.x() / p.z(), p.y() / p.z(), p.z()};
}

void judge_cameras(const Triangulation& raw, const RigCalibration& rig, BentResiduals& bent) {
    Rows<6> rows;  // x, y in the left and right camera, depth, difference in pixels
    double depth = 0;
    for (const auto& point : raw.by_cameras) {
        if (!(std::abs(point.epipolar_px) < kWild_px)) continue;
        const Eigen::Vector3d l = normalised(rig.left_camera, point.p_in_rig),
                              r = normalised(rig.right_camera, point.p_in_rig);
        rows.push_back({l.x(), l.y(), r.x(), r.y(), l.z(), point.epipolar_px});
        depth += l.z();
    }
    const Rows<6> places = medians(rows);
    bent.camera_places = places.size();
    if (places.size() < kLeastPlaces) return;
    depth /= static_cast<double>(rows.size());
    const auto n = static_cast<Eigen::Index>(places.size());
    // What other turns, places, focal lengths and axes of the cameras make of the distances, and what another k1 does.
    Eigen::MatrixXd other(n, 7);
    Eigen::VectorXd by_k1(n), off(n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const auto [x, y, right_x, right_y, z, difference] = places[static_cast<std::size_t>(i)];
        const double far = z / depth - 1;
        other.row(i) << 1, x, y, x * y, y * y, far, far * y;
        by_k1[i] =
            rig.left_camera.focal_y * 0.5 * (y * (x * x + y * y) + right_y * (right_x * right_x + right_y * right_y));
        off[i] = difference;
    }
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> solver(other);
    const Eigen::VectorXd own = by_k1 - other * solver.solve(by_k1), left = off - other * solver.solve(off);
    const double power = own.squaredNorm();
    if (!(power > 0)) return;
    bent.k1_off = own.dot(left) / power;
    const double scatter = (left - bent.k1_off * own).squaredNorm() / static_cast<double>(n - 8);
    bent.k1_sigma = std::sqrt(scatter / power);
}

void judge_projector(const Triangulation& raw, const CameraModel& projector, BentResiduals& bent) {
    Rows<4> rows;  // expected pixel, difference
    for (const auto& point : raw.by_cameras) {
        const auto expected = project(projector, point.p_in_rig);
        if (!expected) continue;
        const Eigen::Vector2d off = point.pixel_in_projector - *expected;
        if (off.norm() < kWild_px) rows.push_back({expected->x(), expected->y(), off.x(), off.y()});
    }
    const Rows<4> places = medians(rows);
    bent.projector_places = places.size();
    if (places.size() < kLeastPlaces) return;
    double squares = 0;
    for (const auto& [x, y, off_x, off_y] : places) squares += off_x * off_x + off_y * off_y;
    bent.projector_px = std::sqrt(squares / static_cast<double>(places.size()));
}

}  // namespace

BentResiduals bent_residuals(const Triangulation& raw, const RigCalibration& rig) {
    BentResiduals bent;
    judge_cameras(raw, rig, bent);
    judge_projector(raw, rig.projector, bent);
    return bent;
}

}  // namespace planlight
