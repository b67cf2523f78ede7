#include "tests/registration/calibration/epipolar_error.h"

namespace planlight::test {

std::optional<double> epipolar_error_px(const CameraModel& true_left, const CameraModel& true_right,
                                        const CameraModel& left, const CameraModel& right,
                                        const Eigen::Vector3d& p_in_rig) {
    const auto left_pixel = project(true_left, p_in_rig), right_pixel = project(true_right, p_in_rig);
    if (!left_pixel || !right_pixel || !in_picture(true_left, *left_pixel) || !in_picture(true_right, *right_pixel))
        return std::nullopt;
    const auto ray = ray_through(left, *left_pixel);
    if (!ray) return std::nullopt;
    const double distance_mm = (p_in_rig - true_left.centre_in_rig()).norm();
    const auto here = project(right, ray->origin + distance_mm * ray->direction);
    const auto farther = project(right, ray->origin + (distance_mm + 1) * ray->direction);
    if (!here || !farther) return std::nullopt;
    const Eigen::Vector2d along = (*farther - *here).normalized(), off = *right_pixel - *here;
    return along.x() * off.y() - along.y() * off.x();
}

}  // namespace planlight::test
