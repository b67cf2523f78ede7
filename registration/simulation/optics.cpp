#include "registration/simulation/optics.h"

#include <cmath>

namespace planlight::simulation {

using Eigen::Vector2d;
using Eigen::Vector3d;

void Optics::look_at(const Vector3d& target, const Vector3d& up, double roll) {
    forward = (target - eye).normalized();
    const Vector3d level = forward.cross(up).normalized();
    const Vector3d plumb = forward.cross(level);
    right = std::cos(roll) * level + std::sin(roll) * plumb;
    down = forward.cross(right);
}

void Optics::turn(const Vector3d& radians) {
    const double angle = radians.norm();
    if (angle == 0) return;
    const Vector3d axis = (radians.x() * right + radians.y() * down + radians.z() * forward) / angle;
    const auto turned = [&](const Vector3d& v) -> Vector3d {  // Rodrigues
        return v * std::cos(angle) + axis.cross(v) * std::sin(angle) + axis * axis.dot(v) * (1 - std::cos(angle));
    };
    right = turned(right);
    forward = turned(forward);
    down = forward.cross(right);
}

Vector2d Optics::bent(const Vector2d& q) const {
    const double square = q.squaredNorm();
    const double growth = square * (radial_per_mm2 + square * radial_per_mm4);
    const double lean = 2 * (decentred_x_per_mm * q.x() + decentred_y_per_mm * q.y());
    return q * (1 + growth + lean) + square * Vector2d(decentred_x_per_mm, decentred_y_per_mm);
}

Vector2d Optics::pixel_of(const Vector3d& p) const {
    const Vector3d way = p - eye;
    const double z = forward.dot(way);
    const Vector2d ideal(focal_mm * right.dot(way) / z, focal_mm * down.dot(way) / z);
    return (axis_mm + bent(ideal)).cwiseQuotient(pitch_mm) - Vector2d(0.5, 0.5);
}

Vector3d Optics::direction_of(const Vector2d& pixel) const {
    const Vector2d wanted = (pixel + Vector2d(0.5, 0.5)).cwiseProduct(pitch_mm) - axis_mm;
    Vector2d ideal = wanted;
    for (int i = 0; i < 60; ++i) {  // the bend is small: what is missing is put on until nothing is missing
        const Vector2d missing = wanted - bent(ideal);
        ideal += missing;
        if (missing.squaredNorm() < 1e-20) break;
    }
    return (focal_mm * forward + ideal.x() * right + ideal.y() * down).normalized();
}

CameraModel Optics::as_camera_model(const RigidTransform& room_from_rig) const {
    CameraModel model;
    model.width = columns;
    model.height = rows;
    model.focal_x = focal_mm / pitch_mm.x();
    model.focal_y = focal_mm / pitch_mm.y();
    model.centre_x = axis_mm.x() / pitch_mm.x() - 0.5;
    model.centre_y = axis_mm.y() / pitch_mm.y() - 0.5;
    const double f2 = focal_mm * focal_mm;
    model.k1 = radial_per_mm2 * f2;
    model.k2 = radial_per_mm4 * f2 * f2;
    model.p1 = decentred_y_per_mm * focal_mm;
    model.p2 = decentred_x_per_mm * focal_mm;
    RigidTransform room_from_device = RigidTransform::Identity();
    room_from_device.linear() << right, down, forward;
    room_from_device.translation() = eye;
    model.device_from_rig = room_from_device.inverse() * room_from_rig;
    return model;
}

Optics Optics::seen_from(const RigidTransform& b_from_room) const {
    Optics moved = *this;
    moved.eye = b_from_room * eye;
    moved.right = b_from_room.linear() * right;
    moved.down = b_from_room.linear() * down;
    moved.forward = b_from_room.linear() * forward;
    return moved;
}

}  // namespace planlight::simulation
