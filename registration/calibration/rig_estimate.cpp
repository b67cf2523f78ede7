#include "registration/calibration/rig_estimate.h"

#include <cmath>

namespace planlight {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

const char* text_of(DeviceName device) {
    switch (device) {
        case DeviceName::left_camera:
            return "left camera";
        case DeviceName::right_camera:
            return "right camera";
        case DeviceName::projector:
            break;
    }
    return "projector";
}

std::size_t RigEstimate::poses() const {
    std::size_t count = 0;
    for (const auto& pose : rig_from_board) count += pose.has_value();
    return count;
}

Vector3d bent(const Vector3d& flat, const Vector3d& bend_mm, const BoardSpec& board) {
    const double half = std::hypot(board.width_mm(), board.height_mm()) / 2;
    const double x = (flat.x() - board.width_mm() / 2) / half, y = (flat.y() - board.height_mm() / 2) / half;
    return {flat.x(), flat.y(), bend_mm.dot(Vector3d(x * x, x * y, y * y))};
}

std::optional<Vector3d> board_point(const CameraModel& camera, const Vector2d& pixel,
                                    const RigidTransform& rig_from_board, const Vector3d& bend_mm,
                                    const BoardSpec& board) {
    const auto ray = ray_through(camera, pixel);
    if (!ray) return std::nullopt;
    const RigidTransform board_from_rig = rig_from_board.inverse();
    const Vector3d origin = board_from_rig * ray->origin, way = board_from_rig.linear() * ray->direction;
    if (std::abs(way.z()) < 1e-3) return std::nullopt;
    Vector3d p = origin - way * (origin.z() / way.z());
    for (int i = 0; i < 2; ++i) p = origin + way * ((bent(p, bend_mm, board).z() - origin.z()) / way.z());
    return p;
}

VectorXd numbers_of(const RigEstimate& rig) {
    std::vector<double> numbers;
    for (const DeviceName name : kDevices) {
        const auto& d = rig.device(name);
        if (!d) continue;
        for (const double v : {d->focal_x, d->focal_y, d->centre_x, d->centre_y, d->k1, d->k2, d->p1, d->p2, d->k3})
            numbers.push_back(v);
        if (name == DeviceName::left_camera) continue;
        const Vector3d turn = rotation_vector(d->device_from_rig.linear()), shift = d->device_from_rig.translation();
        for (int i = 0; i < 3; ++i) numbers.push_back(turn[i]);
        for (int i = 0; i < 3; ++i) numbers.push_back(shift[i]);
    }
    return Eigen::Map<const VectorXd>(numbers.data(), static_cast<Eigen::Index>(numbers.size()));
}

RigEstimate with_numbers(const RigEstimate& rig, const VectorXd& numbers) {
    RigEstimate changed = rig;
    const double* next = numbers.data();
    for (const DeviceName name : kDevices) {
        auto& d = changed.device(name);
        if (!d) continue;
        for (double* v : {&d->focal_x, &d->focal_y, &d->centre_x, &d->centre_y, &d->k1, &d->k2, &d->p1, &d->p2, &d->k3})
            *v = *next++;
        if (name == DeviceName::left_camera) continue;
        Eigen::Matrix<double, 6, 1> twist = Eigen::Map<const Eigen::Matrix<double, 6, 1>>(next);
        next += 6;
        d->device_from_rig = transform_from_twist(twist);
    }
    return changed;
}

}  // namespace planlight
