#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <vector>

#include "planning_io/types/rig_calibration.h"
#include "registration/scan/scan_surface.h"

// A second room for the tests of the scan, strange on purpose: solids said by their distance (rays are marched, not
// solved), light that goes from wall to wall, into the skin and off its gloss, a projector whose black is not black,
// cameras that encode or clip. Its optics and its light share no line with the other rooms.
namespace planlight::solid_room {

using Eigen::Vector3d;

/// Distance (mm) from a point of the room to the nearest surface, negative inside; at most the true one.
using Solid = std::function<double(const Vector3d&)>;

Solid ball(const Vector3d& centre, double radius_mm);
Solid wall(const Vector3d& point, const Vector3d& normal);
/// A head of ellipsoids with nose, brow and two ears of thin folds, about 150 mm wide; its face looks to -z.
Solid head(const Vector3d& centre);
/// A shell: whorls that shrink about an axis across the line of sight, with deep seams, ribs of 2 mm and an open mouth.
/// About 120 mm.
Solid shell(const Vector3d& centre);
/// Steep folds one beside the other, `depth_mm` deep and 14 mm apart, with ridges 1.5 mm thick, on a plate 120 mm wide.
Solid folds(const Vector3d& centre, double depth_mm);

/// A device: pinhole with one distortion number; x right, y down, z forward.
struct Device {
    int width = 0, height = 0;
    double focal = 0, centre_x = 0, centre_y = 0, k1 = 0;
    Eigen::Isometry3d device_from_room = Eigen::Isometry3d::Identity();
};

struct Material {
    double albedo = 0.6;
    double bounced = 1;  ///< how much of the light that other walls send takes part; 0: none
    double gloss = 0,
           gloss_power = 60;  ///< highlight of the projector; and its mirror image in other walls, of the same strength
    double into_skin_px = 0;  ///< spread of the light in the skin, camera pixels (a third of it)
    double texture = 0.1;     ///< spots, share of the albedo
};

struct Photography {
    double white_grey = 170, dark_grey = 9;  ///< of a white wall 600 mm away; the camera's own black and the lamps
    double contrast = 400;                   ///< of the projector: its black is white by this
    double camera_gamma = 1;                 ///< grey = 255 (light / 255)^(1 / gamma)
    double read_noise_grey = 1, shot_noise = 0.06;  ///< one sigma; of the square root of the grey value
    double projector_blur_px = 0.5, camera_blur_px = 0.5;
    unsigned seed = 1;
};

struct Room {
    Device left, right, projector;
    Solid solid;
    Material material;
    Photography photography;
};

/// A small rig 600 mm before the thing, the cameras 160 mm beside the projector; `pixels` times 640 x 480 for the
/// cameras, the projector 912 x 684.
Room desk_room(Solid solid, double pixels = 1);

/// Rays, light paths and all: where each camera pixel's light comes from, so that any pictures can be shown.
class Exposure {
public:
    Exposure(const Room& room, const Device& camera, unsigned seed);
    /// The picture under a pattern whose columns (rows: `along_rows`) have these values, 0 to 1.
    GrayImage picture(const std::vector<double>& values, bool along_rows);
    /// The projector pixel that lights a camera pixel directly; NaN where none does.
    const std::vector<Eigen::Vector2d>& code() const { return code_; }
    const std::vector<Vector3d>& points() const { return points_; }  ///< seen by the camera's pixels, NaN: none

private:
    static constexpr int kLattice_px = 6;  ///< of the places whose light from other walls is traced
    struct Path {
        float u, v, share;
    };
    void trace(const Room& room);
    void bounce(const Room& room);
    const Room& room_;
    const Device& camera_;
    std::vector<std::vector<Path>> direct_;   ///< per sub-sample and pixel, by place: one path or none
    std::vector<std::vector<Path>> bounced_;  ///< per place of the coarse lattice
    std::vector<Path> mirrored_;              ///< per pixel
    std::vector<float> albedo_;
    std::vector<Eigen::Vector2d> code_;
    std::vector<Vector3d> points_;
    unsigned seed_;
};

/// What the projector shows, by column or row, as light of 0 to 1 (its gamma is 1.8). `phase_period_px` 2 and no
/// fringes: a Gray code to single pixels.
std::vector<double> shown(const StripeSettings& stripes, const StripePattern& pattern);

/// Both cameras of a room, which must outlive them. The rays are traced once, for any pictures.
class Cameras {
public:
    explicit Cameras(const Room& room);
    /// The frames of the whole sequence, or of `partial` where it is not empty.
    ScanCapture capture(const StripeSettings& stripes, const std::vector<StripePattern>& partial = {});
    const Exposure& left() const { return left_; }

private:
    Exposure left_, right_;
};

RigCalibration rig_of(const Room& room);

/// How far points lie off the solid, mm, sorted.
std::vector<double> off_the_solid(const PointCloud& cloud, const Solid& solid);

}  // namespace planlight::solid_room
