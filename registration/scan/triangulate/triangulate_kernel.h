#pragma once

#include "planning_io/types/camera_model.h"

// The arithmetic of triangulation over many points side by side, so that it runs in vector registers: least squares
// over all views (Gauss-Newton), weighted by their covariance. Private to registration/scan.
namespace planlight::triangulate_kernel {

/// Points of a block, so that a block stays in the first cache.
inline constexpr int kLanes = 64;

/// A device as plain numbers: `CameraModel`, its rotation row by row, and where it stands.
struct Device {
    double fx, fy, cx, cy, k1, k2, p1, p2, k3;
    double r[9], t[3], eye[3];

    explicit Device(const CameraModel& model);
};

using Lane = double[kLanes];

/// Up to kLanes points. The right pixel, its derivative and its sigma are used by the functions for three views only.
struct alignas(64) Points {
    // Given: camera pixels, projector pixel, the noise of the codes (projector pixels), the right pixel by the code.
    Lane pixel_x, pixel_y, right_x, right_y, code_x, code_y, sigma, right_sigma, by_code_xx, by_code_xy, by_code_yx,
        by_code_yy;
    // Found, in rig, mm.
    Lane x, y, z;                       ///< the point
    Lane start_x, start_y, start_z;     ///< the middle between the two lines of sight
    Lane offset_x, offset_y, epipolar;  ///< the evidence of three views: see Triangulation
    Lane residual_squared, sigma_mm, step_squared;
    Lane cxx, cxy, cxz, cyy, cyz, czz;  ///< covariance
    Lane good;                          ///< 1: every step had an answer; 0: behind a device, rays parallel or the like
};

/// Where two rays pass each other (midpoint method, Hartley & Zisserman 12.2): of both cameras, with the evidence that
/// does without the projector; or of a camera and the projector.
void start_three(const Device& left, const Device& right, const Device& projector, Points& points);
void start_two(const Device& camera, const Device& projector, Points& points);

/// One standard deviation of a pixel by the calibration alone.
struct Sigmas {
    double camera_px, projector_px;
};

/// One Gauss-Newton step of all points, with residual and covariance. The right pixel is where the right view's code
/// equals the left's: the noise of the left code moves both it and the projector pixel, so their covariance is not
/// zero.
void adjust_three(const Device& left, const Device& right, const Device& projector, const Sigmas& sigmas,
                  Points& points);
void adjust_two(const Device& camera, const Device& projector, const Sigmas& sigmas, Points& points);

/// `sigma_mm`: one standard deviation along the worst direction, at most 1 % too small (powers of the covariance).
void find_worst_sigma(Points& points);

}  // namespace planlight::triangulate_kernel
