#include "registration/calibration/volume_error.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

namespace planlight {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr std::array<int, 3> kGrid{9, 7, 5};
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A step for the numeric derivative by each number: about 0.01 px in the picture.
VectorXd steps_for(const VectorXd& numbers, const RigEstimate& rig) {
    VectorXd steps(numbers.size());
    Eigen::Index n = 0;
    for (const DeviceName name : kDevices) {
        if (!rig.device(name)) continue;
        for (int i = 0; i < 9; ++i) steps[n++] = i < 4 ? 0.01 : 1e-4;
        if (name != DeviceName::left_camera)
            for (int i = 0; i < 6; ++i) steps[n++] = i < 3 ? 1e-5 : 0.01;
    }
    return steps;
}

std::vector<Vector3d> corners_in_rig(const RigEstimate& rig, const BoardSpec& board) {
    std::vector<Vector3d> points;
    for (const auto& pose : rig.rig_from_board)
        if (pose)
            for (int id = 0; id < board.corner_count(); ++id) points.push_back(*pose * board.corner_in_board(id));
    return points;
}

/// The 5 to 95 % box of the boards' corners along the axes of a device, as a grid.
void lay_grid(const RigEstimate& rig, const BoardSpec& board, VolumeError& error) {
    const auto& seen_from =
        rig.device(DeviceName::projector) ? *rig.device(DeviceName::projector) : *rig.device(DeviceName::left_camera);
    std::array<std::vector<double>, 3> along;
    for (const Vector3d& p : corners_in_rig(rig, board)) {
        const Vector3d q = seen_from.device_from_rig * p;
        for (int i = 0; i < 3; ++i) along[static_cast<std::size_t>(i)].push_back(q[i]);
    }
    Vector3d low, high;
    for (std::size_t i = 0; i < 3; ++i) {
        std::sort(along[i].begin(), along[i].end());
        low[static_cast<Eigen::Index>(i)] = along[i][along[i].size() / 20];
        high[static_cast<Eigen::Index>(i)] = along[i][along[i].size() * 19 / 20];
    }
    error.grid = kGrid;
    const RigidTransform rig_from_device = seen_from.device_from_rig.inverse();
    for (int z = 0; z < kGrid[2]; ++z)
        for (int y = 0; y < kGrid[1]; ++y)
            for (int x = 0; x < kGrid[0]; ++x) {
                const Vector3d share(x / (kGrid[0] - 1.0), y / (kGrid[1] - 1.0), z / (kGrid[2] - 1.0));
                error.points.push_back(rig_from_device * (low + share.cwiseProduct(high - low)));
            }
}

bool sees(const std::optional<CameraModel>& device, const Vector3d& p) {
    if (!device) return false;
    const auto pixel = project(*device, p);
    return pixel && in_picture(*device, *pixel);
}

/// How a triangulated point moves with the numbers of the rig (3 x numbers), the pixels held; `used`: by which devices.
MatrixXd point_by_numbers(const RigEstimate& rig, const std::vector<RigEstimate>& plus,
                          const std::vector<RigEstimate>& minus, const VectorXd& steps, const Vector3d& p,
                          const std::array<bool, 3>& used) {
    Matrix3d normal = Matrix3d::Zero();
    MatrixXd right = MatrixXd::Zero(3, steps.size());
    for (std::size_t d = 0; d < 3; ++d) {
        if (!used[d]) continue;
        Eigen::Matrix<double, 2, 3> by_point;
        if (!project(*rig.devices[d], p, by_point)) continue;
        const double weight = 1 / (kScanSigma_px[d] * kScanSigma_px[d]);
        normal += weight * by_point.transpose() * by_point;
        for (Eigen::Index n = 0; n < steps.size(); ++n) {
            const auto i = static_cast<std::size_t>(n);
            const auto a = project(*plus[i].devices[d], p), b = project(*minus[i].devices[d], p);
            if (a && b) right.col(n) += weight * by_point.transpose() * ((*a - *b) / (2 * steps[n]));
        }
    }
    return -normal.ldlt().solve(right);
}

/// Takes a common turn and shift out of how the points move.
void remove_common_motion(const std::vector<Vector3d>& points, MatrixXd& by_numbers) {
    Vector3d middle = Vector3d::Zero();
    for (const Vector3d& p : points) middle += p / static_cast<double>(points.size());
    MatrixXd common(by_numbers.rows(), 6);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vector3d arm = (points[i] - middle) / 100;
        const auto r = 3 * static_cast<Eigen::Index>(i);
        common.block<3, 3>(r, 0) << 0, arm.z(), -arm.y(), -arm.z(), 0, arm.x(), arm.y(), -arm.x(), 0;
        common.block<3, 3>(r, 3).setIdentity();
    }
    by_numbers -= common * (common.transpose() * common).ldlt().solve(common.transpose() * by_numbers);
}

double share_of(std::vector<double> values, double share) {
    std::erase_if(values, [](double v) { return std::isnan(v); });
    if (values.empty()) return kNaN;
    std::sort(values.begin(), values.end());
    return values[std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}

}  // namespace

std::optional<Vector3d> triangulate_pixels(const RigEstimate& rig, const PixelsOfPoint& pixels,
                                           const std::array<double, 3>& sigma_px, const Vector3d& near) {
    int devices = 0;
    for (std::size_t d = 0; d < 3; ++d) devices += rig.devices[d] && pixels[d];
    if (devices < 2) return std::nullopt;
    Vector3d p = near;
    for (int round = 0; round < 20; ++round) {
        Matrix3d normal = Matrix3d::Zero();
        Vector3d right = Vector3d::Zero();
        for (std::size_t d = 0; d < 3; ++d) {
            if (!rig.devices[d] || !pixels[d]) continue;
            Eigen::Matrix<double, 2, 3> J;
            const auto pixel = project(*rig.devices[d], p, J);
            if (!pixel) return std::nullopt;
            normal += J.transpose() * J / (sigma_px[d] * sigma_px[d]);
            right += J.transpose() * (*pixels[d] - *pixel) / (sigma_px[d] * sigma_px[d]);
        }
        const Vector3d step = normal.ldlt().solve(right);
        p += step;
        if (step.norm() < 1e-7) return p;
    }
    return std::nullopt;
}

std::optional<VolumeError> predict_volume_error(const BundleResult& calibration, const BoardSpec& board) {
    const RigEstimate& rig = calibration.rig;
    int devices = 0;
    for (const auto& d : rig.devices) devices += d.has_value();
    if (devices < 2 || calibration.covariance.size() == 0 || rig.poses() == 0) return std::nullopt;
    VolumeError error;
    lay_grid(rig, board, error);
    const VectorXd numbers = numbers_of(rig), steps = steps_for(numbers, rig);
    std::vector<RigEstimate> plus, minus;
    for (Eigen::Index n = 0; n < numbers.size(); ++n) {
        plus.push_back(with_numbers(rig, numbers + steps[n] * VectorXd::Unit(numbers.size(), n)));
        minus.push_back(with_numbers(rig, numbers - steps[n] * VectorXd::Unit(numbers.size(), n)));
    }
    const std::size_t count = error.points.size();
    error.seen.assign(count, false);
    error.sigma_mm.assign(count, kNaN);
    const bool lands = rig.devices[0] && rig.devices[1] && rig.devices[2];
    if (lands) error.light_sigma_mm.assign(count, kNaN);
    std::vector<Vector3d> points;
    std::vector<std::size_t> which;
    std::vector<MatrixXd> rows;
    for (std::size_t i = 0; i < count; ++i) {
        const Vector3d& p = error.points[i];
        const std::array<bool, 3> used{sees(rig.devices[0], p), sees(rig.devices[1], p), sees(rig.devices[2], p)};
        if (used[0] + used[1] + used[2] < 2) continue;
        error.seen[i] = true;
        points.push_back(p);
        which.push_back(i);
        rows.push_back(point_by_numbers(rig, plus, minus, steps, p, used));
        if (!lands || !used[0] || !used[1] || !used[2]) continue;
        const MatrixXd by_cameras = point_by_numbers(rig, plus, minus, steps, p, {true, true, false});
        Eigen::Matrix<double, 2, 3> J;
        if (!project(*rig.devices[2], p, J)) continue;
        MatrixXd pixel = J * by_cameras;
        for (Eigen::Index n = 0; n < steps.size(); ++n) {
            const auto k = static_cast<std::size_t>(n);
            const auto a = project(*plus[k].devices[2], p), b = project(*minus[k].devices[2], p);
            if (a && b) pixel.col(n) += (*a - *b) / (2 * steps[n]);
        }
        const double mm_per_px = (rig.devices[2]->device_from_rig * p).z() / rig.devices[2]->focal_x;
        error.light_sigma_mm[i] = mm_per_px * std::sqrt((pixel * calibration.covariance * pixel.transpose()).trace());
    }
    if (points.size() < 6) return std::nullopt;
    MatrixXd all(3 * static_cast<Eigen::Index>(points.size()), numbers.size());
    for (std::size_t i = 0; i < rows.size(); ++i) all.middleRows<3>(3 * static_cast<Eigen::Index>(i)) = rows[i];
    remove_common_motion(points, all);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const MatrixXd one = all.middleRows<3>(3 * static_cast<Eigen::Index>(i));
        error.sigma_mm[which[i]] = std::sqrt(std::max(0.0, (one * calibration.covariance * one.transpose()).trace()));
    }
    error.median_mm = share_of(error.sigma_mm, 0.5);
    error.p95_mm = share_of(error.sigma_mm, 0.95);
    error.worst_mm = share_of(error.sigma_mm, 1);
    if (lands) error.light_p95_mm = share_of(error.light_sigma_mm, 0.95);
    return error;
}

}  // namespace planlight
