#pragma once

#include <Eigen/Core>
#include <optional>

#include "planning_io/types/rigid_transform.h"

namespace planlight {

/// A straight line of sight or of light, in the frame its user names.
struct Ray {
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();      ///< mm
    Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit length
};

/// A pinhole device with Brown-Conrady lens distortion: a camera, or the projector as an inverse camera.
///
/// Device frame: x right, y down, z forward. Pixel (0,0) is the centre of the top-left pixel.
/// Distortion on normalised coordinates as in OpenCV (Brown 1971): radial k1 k2 k3, tangential p1 p2.
struct CameraModel {
    int width = 0, height = 0;                      ///< pixels
    double focal_x = 0, focal_y = 0;                ///< pixels
    double centre_x = 0, centre_y = 0;              ///< principal point, pixels; may lie outside the picture
    double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;  ///< distortion, dimensionless
    RigidTransform device_from_rig = RigidTransform::Identity();

    /// Where the device stands, in rig, mm.
    Eigen::Vector3d centre_in_rig() const { return device_from_rig.inverse().translation(); }
};

/// The pixel at which a rig point is seen (or lit). Empty when the point is not in front of the device, or lies so far
/// outside the field that the distortion polynomial has turned back on itself. May lie outside the picture.
std::optional<Eigen::Vector2d> project(const CameraModel& device, const Eigen::Vector3d& p_in_rig);

/// As `project`, with the derivative of the pixel by the rig point (2x3).
std::optional<Eigen::Vector2d> project(const CameraModel& device, const Eigen::Vector3d& p_in_rig,
                                       Eigen::Matrix<double, 2, 3>& pixel_by_point);

/// The normalised, undistorted coordinates (x/z, y/z in the device frame) of a pixel: Newton's method on the
/// distortion, to 1e-12; empty when it does not converge (a pixel no point is ever seen at).
std::optional<Eigen::Vector2d> undistort(const CameraModel& device, const Eigen::Vector2d& pixel);

/// The ray through a pixel, in rig. Empty as `undistort`.
std::optional<Ray> ray_through(const CameraModel& device, const Eigen::Vector2d& pixel);

/// True when the pixel lies in the picture (its centre at most half a pixel outside the outermost centres).
bool in_picture(const CameraModel& device, const Eigen::Vector2d& pixel);

}  // namespace planlight
