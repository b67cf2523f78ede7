#include "tests/registration/scan/spoilt_rigs.h"

#include <utility>

namespace planlight::scan_rooms {
namespace {

/// Turned about an axis of its own (the upright one), where it stands.
void turn(CameraModel& device, double degrees, const Eigen::Vector3d& axis = Eigen::Vector3d::UnitY()) {
    const Eigen::AngleAxisd by(degrees * M_PI / 180, axis);
    device.device_from_rig = RigidTransform(by) * device.device_from_rig;
}

void stretch(CameraModel& device, double by) {
    device.focal_x *= by;
    device.focal_y *= by;
}

void flip_distortion(CameraModel& device) {
    for (double* k : {&device.k1, &device.k2, &device.k3, &device.p1, &device.p2}) *k = -*k;
}

}  // namespace

std::vector<SpoiltRig> spoilt_rigs() {
    return {
        {"nothing wrong", [](RigCalibration&) {}},
        {"projector turned 0.2 degrees", [](RigCalibration& r) { turn(r.projector, 0.2); }},
        {"right camera turned 0.1 degrees sideways", [](RigCalibration& r) { turn(r.right_camera, 0.1); }},
        {"right camera turned 0.02 degrees upwards",
         [](RigCalibration& r) { turn(r.right_camera, 0.02, Eigen::Vector3d::UnitX()); }},
        {"left focal length +1 %", [](RigCalibration& r) { stretch(r.left_camera, 1.01); }},
        {"both cameras' focal lengths +1 %",
         [](RigCalibration& r) {
             stretch(r.left_camera, 1.01);
             stretch(r.right_camera, 1.01);
         }},
        {"projector focal length +1 %", [](RigCalibration& r) { stretch(r.projector, 1.01); }},
        {"left distortion sign flipped", [](RigCalibration& r) { flip_distortion(r.left_camera); }},
        {"right distortion sign flipped", [](RigCalibration& r) { flip_distortion(r.right_camera); }},
        {"both cameras' distortion signs flipped",
         [](RigCalibration& r) {
             flip_distortion(r.left_camera);
             flip_distortion(r.right_camera);
         }},
        {"projector distortion sign flipped", [](RigCalibration& r) { flip_distortion(r.projector); }},
        {"left and right camera swapped", [](RigCalibration& r) { std::swap(r.left_camera, r.right_camera); }},
    };
}

}  // namespace planlight::scan_rooms
