#pragma once

#include <optional>

#include "tests/registration/scan/solid_room.h"

// Rays and light of the solid room: what its pictures and its figures share.
namespace planlight::solid_room {

constexpr double kFar_mm = 1500;  ///< no ray goes farther

Vector3d normal_at(const Solid& solid, const Vector3d& p);
/// Sphere marching, from `begin` to `end` along the way, mm; empty where nothing is met.
std::optional<double> march(const Solid& solid, const Vector3d& from, const Vector3d& way, double begin, double end);
Vector3d eye_of(const Device& device);
/// Empty behind the device.
std::optional<Eigen::Vector2d> pixel_of(const Device& device, const Vector3d& p);
/// The direction in which a pixel looks, of length 1.
Vector3d way_of(const Device& device, double px, double py);

/// What the projector sends to a place directly: its pixel and how brightly; empty in its shadow.
struct Lit {
    Eigen::Vector2d pixel;
    double brightness;
};
std::optional<Lit> lit_at(const Room& room, const Vector3d& p, const Vector3d& normal);

}  // namespace planlight::solid_room
