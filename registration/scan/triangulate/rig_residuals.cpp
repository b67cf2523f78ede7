#include "registration/scan/triangulate/rig_residuals.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>

namespace planlight {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6x3 = Eigen::Matrix<double, 6, 3>;
using Rows = Eigen::Matrix<double, 6, kRigNumbers>;

constexpr std::array<double, kRigDevices> kSigma_px{0.1, 0.1, 0.15};  // of a code, without what the calibration leaves
constexpr double kHuber = 3, kWorstResidual = 6;                      // sigmas
constexpr double kMedianOfThree = 2.366;                              // of chi-square with three degrees of freedom

/// One device's part: whitened difference, derivative by the point and by the ten numbers.
bool linearise(const CameraModel& device, double sigma, const Eigen::Vector2d& seen, const Eigen::Vector3d& p_in_rig,
               Eigen::Ref<Eigen::Vector2d> difference, Eigen::Ref<Eigen::Matrix<double, 2, 3>> by_point,
               Eigen::Ref<Eigen::Matrix<double, 2, 10>> by_numbers) {
    Eigen::Matrix<double, 2, 3> by_rig;
    const auto pixel = project(device, p_in_rig, by_rig);
    if (!pixel) return false;
    const Eigen::Vector3d p = device.device_from_rig * p_in_rig;
    const Eigen::Matrix<double, 2, 3> by_device = by_rig * device.device_from_rig.linear().transpose();
    const Eigen::Vector2d from_centre = *pixel - Eigen::Vector2d(device.centre_x, device.centre_y);
    const Eigen::Vector2d n = p.head<2>() / p.z();
    for (int k = 0; k < 3; ++k) by_numbers.col(k) = by_device * Eigen::Vector3d::Unit(k).cross(p);
    by_numbers.middleCols<3>(3) = by_device;
    by_numbers.col(6) = from_centre;
    by_numbers.middleCols<2>(7).setIdentity();
    by_numbers.col(9) = n.squaredNorm() * n.cwiseProduct(Eigen::Vector2d(device.focal_x, device.focal_y));
    by_numbers /= sigma;
    by_point = by_rig / sigma;
    difference = (seen - *pixel) / sigma;
    return true;
}

struct Linear {
    Vector6 difference;
    Matrix6x3 by_point;
    Rows by_numbers = Rows::Zero();
};

std::optional<Linear> linearise(const SeenPlace& place, const RigCalibration& rig) {
    Linear linear;
    for (std::size_t d = 0; d < kRigDevices; ++d) {
        const auto row = 2 * static_cast<Eigen::Index>(d), column = 10 * static_cast<Eigen::Index>(d);
        Eigen::Vector2d difference;
        Eigen::Matrix<double, 2, 3> by_point;
        Eigen::Matrix<double, 2, 10> by_numbers;
        if (!linearise(device_of(rig, static_cast<RigDevice>(d)), kSigma_px[d], place.pixels[d], place.p_in_rig,
                       difference, by_point, by_numbers))
            return std::nullopt;
        linear.difference.segment<2>(row) = difference;
        linear.by_point.middleRows<2>(row) = by_point;
        linear.by_numbers.block<2, 10>(row, column) = by_numbers;
    }
    return linear;
}

double median_of(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace

RigCalibration changed(const RigCalibration& rig, const RigNumbers& numbers) {
    RigCalibration other = rig;
    for (std::size_t d = 0; d < kRigDevices; ++d) {
        CameraModel& device = device_of(other, static_cast<RigDevice>(d));
        device = changed(device, numbers.segment<10>(10 * static_cast<Eigen::Index>(d)));
    }
    return other;
}

RigResiduals rig_residuals(std::vector<SeenPlace>& places, const RigCalibration& rig, double independent) {
    struct Row {
        Eigen::Matrix<double, 6, kRigNumbers> J;
        Vector6 r;
    };
    std::vector<Row> rows;
    std::vector<double> squares;
    rows.reserve(places.size());
    for (SeenPlace& place : places) {
        if (const auto p = point_of_pixels(rig, place.pixels, place.p_in_rig)) place.p_in_rig = *p;
        const auto linear = linearise(place, rig);
        if (!linear) continue;
        const Eigen::Matrix3d inverse = (linear->by_point.transpose() * linear->by_point).inverse();
        const Eigen::Matrix<double, 6, 6> left =
            Eigen::Matrix<double, 6, 6>::Identity() - linear->by_point * inverse * linear->by_point.transpose();
        rows.push_back({left * linear->by_numbers, left * linear->difference});
        squares.push_back(rows.back().r.squaredNorm());
    }
    RigResiduals found;
    if (rows.empty()) return found;
    const double median = median_of(squares), scale = std::max(1.0, std::sqrt(median / kMedianOfThree));
    const double share = independent / static_cast<double>(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const double size = std::sqrt(squares[i]);
        const double weight = share * std::min(1.0, kHuber * scale / std::max(size, 1e-12));
        found.normal.noalias() += weight * rows[i].J.transpose() * rows[i].J;
        found.right.noalias() += weight * rows[i].J.transpose() * rows[i].r;
        found.chi_square += share * std::min(squares[i], kWorstResidual * kWorstResidual);
    }
    found.usual = std::sqrt(median / kMedianOfThree);
    return found;
}

}  // namespace planlight
