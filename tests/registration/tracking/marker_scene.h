#pragma once

#include <Eigen/Geometry>
#include <random>
#include <vector>

#include "planning_io/types/rig_calibration.h"
#include "registration/devices/stereo_camera.h"

namespace planlight::test {

/// A flat round sticker in space: its centre and outward normal, mm.
struct Sticker {
    Eigen::Vector3d centre;
    Eigen::Vector3d normal;
    double disc_radius_mm = 4, sticker_radius_mm = 8;
    bool covered = false;  ///< a hand lies on it
};

/// How a camera sees: grey values of what is lit, and what the lens and the sensor add.
struct Look {
    double black = 25, skin = 95, white = 190;
    double light = 1;           ///< factor on the above
    double shading_per_px = 0;  ///< relative change of the light per pixel to the right
    double blur_px = 0.7;
    double noise = 2;
    bool stray_lines = false;  ///< bright projected lines across the skin
};

/// A picture of stickers on a skin-coloured plane behind them: rays through every pixel (16 in each where it matters)
/// cut with the stickers' planes. The rays come from cv::undistortPoints, not from the product's camera model.
GrayImage render(const CameraModel& camera, const std::vector<Sticker>& stickers_in_rig, const Look& look,
                 std::mt19937& random);

/// Two cameras and no light, of about the paper's optics (744x576, f 2090 px) or modern ones (1920x1200, f 5080 px):
/// 450 mm apart, looking at a point 900 mm away, with lens distortion.
RigCalibration paper_rig();
RigCalibration modern_rig();
CameraModel paper_camera();
CameraModel modern_camera();

/// Where cv::projectPoints sees a point.
Eigen::Vector2d seen_at(const CameraModel& camera, const Eigen::Vector3d& p_in_rig);

/// Six stickers on the front of a head of 80 mm radius, without symmetry; the middle of the head is the origin.
std::vector<Sticker> stickers_on_head();

/// Where the head's middle is in rig when nothing moved.
Eigen::Vector3d head_centre();

std::vector<Sticker> moved(const RigidTransform& b_from_a, std::vector<Sticker> stickers);

StereoFrame render_frame(const RigCalibration& rig, const std::vector<Sticker>& stickers_in_rig, const Look& look,
                         Instant at, std::mt19937& random);

/// A turn about the head's middle (degrees) and a shift (mm).
RigidTransform head_move(const Eigen::Vector3d& turn_deg, const Eigen::Vector3d& shift_mm);

}  // namespace planlight::test
