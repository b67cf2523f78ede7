#include "registration/simulation/rig_layout.h"

#include <array>
#include <chrono>
#include <cmath>

namespace planlight::simulation {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

double between(std::mt19937& random, double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
}

/// `k1` and the like as the usual lens tables give them (for a focal length of 1), turned into the lens's millimetres.
void bend(Optics& device, double k1, double k2, double p1, double p2) {
    const double f2 = device.focal_mm * device.focal_mm;
    device.radial_per_mm2 = k1 / f2;
    device.radial_per_mm4 = k2 / (f2 * f2);
    device.decentred_y_per_mm = p1 / device.focal_mm;
    device.decentred_x_per_mm = p2 / device.focal_mm;
}

Optics build_camera(bool paper, double side_mm, std::mt19937& random) {
    Optics camera;
    camera.columns = paper ? 744 : 1920;
    camera.rows = paper ? 576 : 1200;
    const double pitch = paper ? 8.3e-3 : 3.45e-3, field_mm = paper ? 310 : 340;
    camera.pitch_mm = {pitch, pitch * (1 + between(random, -2e-4, 2e-4))};
    camera.eye = {side_mm + between(random, -15, 15), between(random, -60, -10), between(random, -880, -820)};
    camera.focal_mm = camera.eye.norm() / field_mm * camera.columns * pitch * between(random, 0.99, 1.01);
    camera.axis_mm = Vector2d(camera.columns * pitch, camera.rows * pitch) / 2 +
                     pitch * Vector2d(between(random, -12, 12), between(random, -12, 12));
    camera.look_at({between(random, -6, 6), between(random, -6, 6), 0}, {0, -1, 0}, between(random, -0.03, 0.03));
    bend(camera, between(random, -0.2, -0.1), between(random, -0.1, 0.2), between(random, -5e-4, 5e-4),
         between(random, -5e-4, 5e-4));
    return camera;
}

Optics build_projector(bool paper, double distance_mm, std::mt19937& random) {
    Optics projector;
    projector.columns = paper ? 800 : 1920;
    projector.rows = paper ? 600 : 1080;
    const double field_mm = paper ? 320 : 400, pitch = paper ? 14e-3 : 7.6e-3;
    projector.pitch_mm = {pitch, pitch};
    projector.focal_mm = distance_mm / field_mm * projector.columns * pitch * between(random, 0.99, 1.01);
    // Lens shift: the axis leaves near the lower edge of the picture, the picture's middle still falls on the working
    // point.
    const double low = between(random, 0.93, 1.0);
    projector.axis_mm = {(projector.columns / 2.0 + between(random, -8, 8)) * pitch, low * projector.rows * pitch};
    const double lift_mm = (low - 0.5) * projector.rows * field_mm / projector.columns;
    projector.eye = {between(random, -15, 15), lift_mm, -distance_mm};
    projector.look_at({projector.eye.x(), projector.eye.y(), 0}, {0, -1, 0}, between(random, -0.02, 0.02));
    bend(projector, between(random, -0.05, 0.02), between(random, -0.03, 0.03), between(random, -3e-4, 3e-4),
         between(random, -3e-4, 3e-4));
    return projector;
}

/// A calibration's error in one device. What the lens values get wrong, the pose makes up for at the working point, as
/// it does in a calibration that fits its pictures; a little of it stays.
void disturb(Optics& device, double scale, double working_distance_mm, std::mt19937& random) {
    std::normal_distribution<double> unit;
    const double f_px = device.focal_mm / device.pitch_mm.x();
    const double stretch = 2e-4 * scale * unit(random);
    device.focal_mm *= 1 + stretch;
    device.eye -= device.forward * stretch * working_distance_mm;
    const Vector2d shift_px = 0.15 * scale * Vector2d(unit(random), unit(random));
    device.axis_mm += shift_px.cwiseProduct(device.pitch_mm);
    device.turn(Vector3d(-shift_px.y(), shift_px.x(), 0) / f_px);
    // 0.05 px in the corner of the picture.
    const double corner_mm =
        Vector2d(device.columns * device.pitch_mm.x(), device.rows * device.pitch_mm.y()).norm() / 2;
    device.radial_per_mm2 += 0.05 * scale * unit(random) * device.pitch_mm.x() / (corner_mm * corner_mm * corner_mm);
    device.turn(0.04 * scale / f_px * Vector3d(unit(random), unit(random), 0));
    device.turn(Vector3d(0, 0, 0.005 * scale * unit(random) * M_PI / 180));
    const double pixel_mm = working_distance_mm / f_px;
    device.eye += scale * (0.04 * pixel_mm * (unit(random) * device.right + unit(random) * device.down) +
                           0.05 * unit(random) * device.forward);
}

double reprojection_rms_px(const RigLayout& truth, const RigLayout& found) {
    double sum = 0;
    int count = 0;
    const auto add = [&](const Optics& a, const Optics& b) {
        for (double x : {-100.0, 0.0, 100.0})
            for (double y : {-80.0, 0.0, 80.0})
                for (double z : {-60.0, 0.0, 60.0}) {
                    sum += (a.pixel_of({x, y, z}) - b.pixel_of({x, y, z})).squaredNorm();
                    ++count;
                }
    };
    add(truth.left_camera, found.left_camera);
    add(truth.right_camera, found.right_camera);
    add(truth.projector, found.projector);
    return std::sqrt(sum / count);
}

}  // namespace

RigLayout build_rig(Preset preset, std::mt19937& random) {
    const bool paper = preset == Preset::paper;
    RigLayout rig;
    rig.working_distance_mm = between(random, 880, 920);
    const double half_baseline = between(random, 205, 245);
    rig.left_camera = build_camera(paper, -half_baseline, random);
    rig.right_camera = build_camera(paper, half_baseline, random);
    rig.projector = build_projector(paper, rig.working_distance_mm, random);
    rig.left_blur_px = between(random, 0.5, 0.8);
    rig.right_blur_px = between(random, 0.5, 0.8);
    rig.frame_interval = paper ? Instant(std::chrono::milliseconds(40)) : Instant(1'000'000'000 / 60);
    rig.exposure = std::chrono::milliseconds(8);
    std::normal_distribution<double> unit;
    const Eigen::Quaterniond turn(unit(random), unit(random), unit(random), unit(random));
    rig.room_from_rig.linear() = turn.normalized().toRotationMatrix();
    rig.room_from_rig.translation() =
        Vector3d(between(random, -600, 600), between(random, -600, 600), between(random, -600, 600));
    return rig;
}

RigCalibration exported(const RigLayout& rig) {
    RigCalibration calibration;
    calibration.left_camera = rig.left_camera.as_camera_model(rig.room_from_rig);
    calibration.right_camera = rig.right_camera.as_camera_model(rig.room_from_rig);
    calibration.projector = rig.projector.as_camera_model(rig.room_from_rig);
    calibration.made_on = "2024-01-01";
    return calibration;
}

RigCalibration calibrated(const RigLayout& rig, double scale, std::mt19937& random) {
    RigLayout found = rig;
    disturb(found.left_camera, scale, rig.left_camera.eye.norm(), random);
    disturb(found.right_camera, scale, rig.right_camera.eye.norm(), random);
    disturb(found.projector, 2 * scale, rig.working_distance_mm, random);
    RigCalibration calibration = exported(found);
    calibration.reprojection_rms_px = reprojection_rms_px(rig, found);
    return calibration;
}

}  // namespace planlight::simulation
