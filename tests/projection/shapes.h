#pragma once

#include "planning_io/types/camera_model.h"
#include "planning_io/types/image.h"
#include "planning_io/types/triangle_mesh.h"
#include "projection/skin_surface.h"

namespace planlight::test {

/// A ball of that radius at the origin, from an icosahedron halved `halvings` times (edges about 1.1 r / 2^halvings).
TriangleMesh ball_mesh(double radius_mm, int halvings);

/// A ball of 80 mm as a skin, made once, and a point on it (radians).
constexpr double kBallRadius_mm = 80;
const SkinSurface& ball();
Eigen::Vector3d on_ball(double longitude, double latitude);

/// A tube along z, open at both ends, its outside out.
TriangleMesh tube_mesh(double radius_mm, double length_mm, double edge_mm);

/// A square in the x-y plane round the origin, its outside towards +z, of uneven triangles.
TriangleMesh sheet_mesh(double side_mm, double edge_mm);

/// A ball at the origin that a scan cut off at the height z: a flat lid there, flagged so.
TriangleMesh cut_ball_mesh(double radius_mm, double cut_z_mm, SkinFlag lid = kCutPlane);

/// All triangles of both.
TriangleMesh both(TriangleMesh a, const TriangleMesh& b, const Eigen::Vector3d& shift_of_b_mm);

/// A 1920 x 1080 projector with strong lens distortion and an off-axis centre, `distance_mm` before the point it looks
/// at; its picture's up is `up`.
CameraModel projector_looking_at(const Eigen::Vector3d& target_in_rig, const Eigen::Vector3d& from_direction,
                                 double distance_mm, const Eigen::Vector3d& up);

/// The light of a picture's number in a projector of gamma 2.2, 1 = full.
double light_of_number(std::uint8_t number);

/// Writes a picture for a person to look at, when the environment names a folder in PLANLIGHT_PICTURES.
void keep_picture(const RgbImage& picture, const char* name);

}  // namespace planlight::test
