#include "planning_io/types/camera_model.h"

namespace planlight {
namespace {

/// The distorted normalised point, and its derivative by the undistorted one.
Eigen::Vector2d distort(const CameraModel& d, const Eigen::Vector2d& n, Eigen::Matrix2d& by_n) {
    const double x = n.x(), y = n.y(), r2 = x * x + y * y;
    const double radial = 1 + r2 * (d.k1 + r2 * (d.k2 + r2 * d.k3));
    const double radial_by_r2 = d.k1 + r2 * (2 * d.k2 + 3 * r2 * d.k3);
    by_n << radial + 2 * x * x * radial_by_r2 + 2 * d.p1 * y + 6 * d.p2 * x,  //
        2 * x * y * radial_by_r2 + 2 * d.p1 * x + 2 * d.p2 * y,               //
        2 * x * y * radial_by_r2 + 2 * d.p1 * x + 2 * d.p2 * y,               //
        radial + 2 * y * y * radial_by_r2 + 6 * d.p1 * y + 2 * d.p2 * x;
    return {x * radial + 2 * d.p1 * x * y + d.p2 * (r2 + 2 * x * x),
            y * radial + d.p1 * (r2 + 2 * y * y) + 2 * d.p2 * x * y};
}

}  // namespace

std::optional<Eigen::Vector2d> project(const CameraModel& device, const Eigen::Vector3d& p_in_rig) {
    Eigen::Matrix<double, 2, 3> unused;
    return project(device, p_in_rig, unused);
}

std::optional<Eigen::Vector2d> project(const CameraModel& device, const Eigen::Vector3d& p_in_rig,
                                       Eigen::Matrix<double, 2, 3>& pixel_by_point) {
    const Eigen::Vector3d p = device.device_from_rig * p_in_rig;
    if (!(p.z() > 1e-6)) return std::nullopt;
    const Eigen::Vector2d n = p.head<2>() / p.z();
    Eigen::Matrix2d distorted_by_n;
    const Eigen::Vector2d distorted = distort(device, n, distorted_by_n);
    if (!(distorted_by_n.determinant() > 0) || !(distorted_by_n(0, 0) > 0)) return std::nullopt;
    Eigen::Matrix<double, 2, 3> n_by_p;
    n_by_p << 1 / p.z(), 0, -n.x() / p.z(), 0, 1 / p.z(), -n.y() / p.z();
    const Eigen::DiagonalMatrix<double, 2> focal(device.focal_x, device.focal_y);
    pixel_by_point = focal * (distorted_by_n * n_by_p * device.device_from_rig.linear());
    return Eigen::Vector2d(device.focal_x * distorted.x() + device.centre_x,
                           device.focal_y * distorted.y() + device.centre_y);
}

std::optional<Eigen::Vector2d> undistort(const CameraModel& device, const Eigen::Vector2d& pixel) {
    const Eigen::Vector2d wanted((pixel.x() - device.centre_x) / device.focal_x,
                                 (pixel.y() - device.centre_y) / device.focal_y);
    Eigen::Vector2d n = wanted;
    for (int iteration = 0; iteration < 30; ++iteration) {
        Eigen::Matrix2d by_n;
        const Eigen::Vector2d error = distort(device, n, by_n) - wanted;
        if (!(by_n.determinant() > 0)) return std::nullopt;
        if (error.squaredNorm() < 1e-24) return n;
        n -= by_n.inverse() * error;
    }
    return std::nullopt;
}

std::optional<Ray> ray_through(const CameraModel& device, const Eigen::Vector2d& pixel) {
    const auto n = undistort(device, pixel);
    if (!n) return std::nullopt;
    const Eigen::Vector3d direction = device.device_from_rig.linear().transpose() * n->homogeneous();
    return Ray{device.centre_in_rig(), direction.normalized()};
}

bool in_picture(const CameraModel& device, const Eigen::Vector2d& pixel) {
    return pixel.x() >= -0.5 && pixel.y() >= -0.5 && pixel.x() < device.width - 0.5 && pixel.y() < device.height - 0.5;
}

}  // namespace planlight
