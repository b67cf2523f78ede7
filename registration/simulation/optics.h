#pragma once

#include <Eigen/Geometry>

#include "planning_io/types/camera_model.h"

namespace planlight::simulation {

/// A device as a workshop would describe it: where it stands, what it looks at, its lens in millimetres, its sensor (or
/// panel) in millimetres. Room frame, mm. The picture runs right and down from the sensor's top left corner; the centre
/// of the first pixel is half a pitch away from that corner.
struct Optics {
    int columns = 0, rows = 0;
    Eigen::Vector3d eye{0, 0, 0};
    Eigen::Vector3d right{1, 0, 0}, down{0, 1, 0}, forward{0, 0, 1};  ///< unit, orthogonal

    double focal_mm = 0;             ///< lens to sensor
    Eigen::Vector2d pitch_mm{0, 0};  ///< of the pixels, across and down
    Eigen::Vector2d axis_mm{0, 0};   ///< where the optical axis meets the sensor, from its top left corner
    double radial_per_mm2 = 0, radial_per_mm4 = 0;          ///< relative growth of the image radius
    double decentred_x_per_mm = 0, decentred_y_per_mm = 0;  ///< of a lens that is not quite centred

    /// Turns the device so that its axis meets `target`, then by `roll` (radians) about the axis. `up` is only a hint.
    void look_at(const Eigen::Vector3d& target, const Eigen::Vector3d& up, double roll);

    /// Turns the device by a small rotation vector given in its own axes (right, down, forward).
    void turn(const Eigen::Vector3d& radians);

    /// Depth of a room point along the axis, mm.
    double depth(const Eigen::Vector3d& p_in_room) const { return forward.dot(p_in_room - eye); }

    /// Pixel (0,0 = centre of the first) of a room point in front of the device.
    Eigen::Vector2d pixel_of(const Eigen::Vector3d& p_in_room) const;

    /// Unit direction in the room of the light through a pixel.
    Eigen::Vector3d direction_of(const Eigen::Vector2d& pixel) const;

    /// The same device in the words of the product. `room_from_rig` places the rig frame.
    CameraModel as_camera_model(const RigidTransform& room_from_rig) const;

    /// The device moved into another frame (`b_from_room`), for rendering.
    Optics seen_from(const RigidTransform& b_from_room) const;

private:
    /// Where the lens puts a point of the ideal image plane, mm from the axis.
    Eigen::Vector2d bent(const Eigen::Vector2d& ideal_mm) const;
};

}  // namespace planlight::simulation
