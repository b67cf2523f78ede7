#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <optional>
#include <random>
#include <vector>

#include "planning_io/types/rig_calibration.h"
#include "registration/scan/scan_surface.h"

// A small room with optics of its own for the tests of the scan: OpenCV bends the rays, this file lights them.
namespace planlight::stripe_room {

/// A device said OpenCV's way: p_in_device = R p_in_room + t; distortion k1 k2 p1 p2 k3.
struct Optics {
    int width = 0, height = 0;
    double fx = 0, fy = 0, cx = 0, cy = 0;
    std::array<double, 5> distortion{};
    Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
    Eigen::Vector3d t = Eigen::Vector3d::Zero();

    Eigen::Vector3d eye() const { return -R.transpose() * t; }
    std::vector<Eigen::Vector2d> pixels_of(const std::vector<Eigen::Vector3d>& points) const;
    std::vector<Eigen::Vector3d> directions_of(
        const std::vector<Eigen::Vector2d>& pixels) const;  ///< in the room, unit
};

/// First hit along a ray: distance (mm, direction of unit length) and normal.
struct Hit {
    double distance = 0;
    Eigen::Vector3d normal;
};
using Surface = std::function<std::optional<Hit>(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction)>;
Surface plane(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, double radius_mm = 1e9);
Surface sphere(const Eigen::Vector3d& centre, double radius_mm);
Surface nearest_of(std::vector<Surface> surfaces);

struct Light {
    double gamma = 2.2;
    double projector_blur_px = 0.6, camera_blur_px = 0.6;
    double ambient_grey = 18, white_grey = 190;  ///< of a surface that faces the projector
    double noise_grey = 1.5;
    double glint_grey = 0,
           glint_power = 300;  ///< mirrored light where the normal halves the way (Blinn), of full projector light
    unsigned seed = 1;
};

struct Room {
    Optics left, right, projector;
    Surface surface;
    Light light;
};

/// The paper's set-up (800x600 projector over 24x32 cm, cameras of 744x576), and a modern one (1920x1080, 1920x1200).
Room paper_room(Surface surface);
Room modern_room(Surface surface);

/// Per camera pixel what it truly sees: the projector pixel that lights it (NaN where none does) and the point.
struct Truth {
    std::vector<Eigen::Vector2d> code;
    std::vector<Eigen::Vector3d> point;
};
Truth truth_of(const Room& room, const Optics& camera);

/// A picture for the projector whose columns (or rows, `along_rows`) are each of one grey.
struct Shown {
    RgbImage picture;
    bool along_rows = false;
};
std::vector<GrayImage> photograph(const Room& room, const Optics& camera, const std::vector<Shown>& pictures,
                                  unsigned seed);

/// The frames of one camera.
std::vector<GrayImage> photograph(const Room& room, const Optics& camera, const StripeSettings& stripes, unsigned seed);
ScanCapture capture(const Room& room, const StripeSettings& stripes);
StripeSettings stripes_of(const Room& room);

/// The same optics in the product's words.
CameraModel model_of(const Optics& optics);
RigCalibration rig_of(const Room& room);

}  // namespace planlight::stripe_room
