#include "registration/tracking/pose_uncertainty.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "registration/tracking/fit_pose.h"

namespace planlight {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Matrix23 = Eigen::Matrix<double, 2, 3>;
using Matrix63 = Eigen::Matrix<double, 6, 3>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

// What a good calibration (0.1 px rms over all devices) leaves, one sigma each; measured on the simulated rooms
// (ACCURACY.md, measure_tracking). Larger where the calibration says it is worse.
constexpr double kUsualRms_px = 0.1;
constexpr double kDirection_px = 0.045, kRoll_rad = 1e-4, kAside_px = 0.045, kDepth_mm = 0.055;
constexpr double kFocal = 2e-4;         // with the distance that makes up for it
constexpr double kPrincipal_px = 0.12;  // with the turn that makes up for it
constexpr double kCorner_px = 0.05;     // distortion, in the picture's corner
constexpr int kWays = 10;

RigidTransform turned(const RigidTransform& device_from_rig, const Vector3d& radians) {
    Eigen::Matrix<double, 6, 1> twist = Eigen::Matrix<double, 6, 1>::Zero();
    twist.head<3>() = radians;
    return transform_from_twist(twist) * device_from_rig;
}

RigidTransform shifted(const RigidTransform& device_from_rig, const Vector3d& shift_mm) {
    return Eigen::Translation3d(shift_mm) * device_from_rig;
}

/// The camera, wrong by one sigma in one way. `depth_mm`: of the markers before it.
CameraModel wrong_by(CameraModel camera, int way, double depth_mm, double scale) {
    const double f = camera.focal_x, per_px_mm = depth_mm / f;
    RigidTransform& pose = camera.device_from_rig;
    switch (way) {
        case 0:
            pose = turned(pose, {scale * kDirection_px / f, 0, 0});
            break;
        case 1:
            pose = turned(pose, {0, scale * kDirection_px / f, 0});
            break;
        case 2:
            pose = turned(pose, {0, 0, scale * kRoll_rad});
            break;
        case 3:
            pose = shifted(pose, {scale * kAside_px * per_px_mm, 0, 0});
            break;
        case 4:
            pose = shifted(pose, {0, scale * kAside_px * per_px_mm, 0});
            break;
        case 5:
            pose = shifted(pose, {0, 0, scale * kDepth_mm});
            break;
        case 6:
            camera.focal_x *= 1 + scale * kFocal;
            camera.focal_y *= 1 + scale * kFocal;
            pose = shifted(pose, {0, 0, scale * kFocal * depth_mm});
            break;
        case 7:
            camera.centre_x += scale * kPrincipal_px;
            pose = turned(pose, {0, -scale * kPrincipal_px / f, 0});
            break;
        case 8:
            camera.centre_y += scale * kPrincipal_px;
            pose = turned(pose, {scale * kPrincipal_px / f, 0, 0});
            break;
        default: {
            const double corner = std::hypot(camera.width, camera.height) / 2 / f;
            camera.k1 += scale * kCorner_px / (f * corner * corner * corner);
        }
    }
    return camera;
}

/// How the pixel of a point moves when the camera is wrong.
Vector2d pixel_error(const CameraModel& right, const CameraModel& wrong, const Vector3d& p_in_rig) {
    const auto a = project(right, p_in_rig), b = project(wrong, p_in_rig);
    return a && b ? Vector2d(*b - *a) : Vector2d::Zero();
}

/// A reference marker as both cameras measured it: how its place follows from its pixels. Zero where it does not lie in
/// both pictures: then it was not measured in this rig, and nothing of the cameras' errors cancels.
struct Reference {
    Vector3d p_in_rig = Vector3d::Zero();
    std::array<Matrix23, 2> pixel_by_point{Matrix23::Zero(), Matrix23::Zero()};  ///< left, right
    Matrix3d from_pixels = Matrix3d::Zero();                                     ///< (J^T J)^-1
    Matrix3d covariance_mm2 = Matrix3d::Zero();
};

Reference reference_of(const RigCalibration& rig, const PatientMarker& marker) {
    Reference reference;
    reference.p_in_rig = marker.centre_in_patient;  // `patient` equals `rig` there
    Matrix3d N = Matrix3d::Zero();
    for (const bool left : {true, false}) {
        Matrix23& J = reference.pixel_by_point[left ? 0 : 1];
        const CameraModel& camera = left ? rig.left_camera : rig.right_camera;
        const auto pixel = project(camera, reference.p_in_rig, J);
        if (!pixel || !in_picture(camera, *pixel)) J.setZero();
        N += J.transpose() * J;
    }
    const Eigen::LDLT<Matrix3d> solver(N);
    if (solver.info() != Eigen::Success || !(solver.vectorD().minCoeff() > 1e-9)) {
        reference.covariance_mm2 = marker.sigma_mm * marker.sigma_mm * Matrix3d::Identity();
        return reference;
    }
    reference.from_pixels = solver.solve(Matrix3d::Identity());
    reference.covariance_mm2 =
        reference.from_pixels * (3 * marker.sigma_mm * marker.sigma_mm / reference.from_pixels.trace());
    return reference;
}

/// Of the centre in this frame against the reference: what a tilted disc's centre is off under perspective is the same
/// as long as the head has not turned.
double noise_px(const MarkerObservation& seen, double turned_rad) {
    constexpr double kOtherTilt_rad = 0.8;
    const double steady = std::min(seen.steady_px, seen.sigma_px), changed = std::min(1., turned_rad / kOtherTilt_rad);
    return std::sqrt(seen.sigma_px * seen.sigma_px - steady * steady * (1 - changed * changed));
}

struct Seen {
    const Sighting* sighting = nullptr;
    Matrix23 pixel_by_point;
    Eigen::Matrix<double, 2, 6> J;
    Eigen::Matrix<double, 6, 2> twist_by_pixel;  ///< how the fit's turn and shift follow the sighting
};

}  // namespace

PoseUncertainty pose_uncertainty(const RigCalibration& rig, const std::vector<PatientMarker>& markers,
                                 const std::vector<Sighting>& sightings, const RigidTransform& pose) {
    PoseUncertainty result;
    result.of_turn_and_shift.setConstant(std::numeric_limits<double>::infinity());
    Vector3d& middle = result.middle_in_rig;
    for (const PatientMarker& m : markers) middle += pose * m.centre_in_patient / static_cast<double>(markers.size());
    Matrix6 N = Matrix6::Zero();
    std::vector<Seen> seen;
    for (const Sighting& s : sightings) {
        Seen one;
        one.sighting = &s;
        const Vector3d p = pose * markers[static_cast<std::size_t>(s.marker)].centre_in_patient;
        if (!project(s.left ? rig.left_camera : rig.right_camera, p, one.pixel_by_point)) return result;
        one.J = one.pixel_by_point * movement_by_twist(p - middle);
        N += one.J.transpose() * one.J / std::pow(sighting_sigma_px(s.seen), 2);
        seen.push_back(one);
    }
    const Eigen::LDLT<Matrix6> solver(N);
    if (solver.info() != Eigen::Success || !(solver.vectorD().minCoeff() > 0)) return result;
    for (Seen& s : seen)
        s.twist_by_pixel = solver.solve(s.J.transpose()) / std::pow(sighting_sigma_px(s.sighting->seen), 2);

    Matrix6& C = result.of_turn_and_shift;
    C.setZero();
    const double turned_rad = angle_between(pose, RigidTransform::Identity());
    for (const Seen& s : seen)
        C += s.twist_by_pixel * s.twist_by_pixel.transpose() * std::pow(noise_px(s.sighting->seen, turned_rad), 2);
    std::vector<Reference> references;
    for (std::size_t k = 0; k < markers.size(); ++k) {
        references.push_back(reference_of(rig, markers[k]));
        Matrix63 by_place = Matrix63::Zero();
        for (const Seen& s : seen)
            if (s.sighting->marker == static_cast<int>(k))
                by_place -= s.twist_by_pixel * s.pixel_by_point * pose.linear();
        C += by_place * references.back().covariance_mm2 * by_place.transpose();
    }
    const double scale = rig.reprojection_rms_px > 0 ? std::clamp(rig.reprojection_rms_px / kUsualRms_px, 0.7, 5.) : 1;
    for (const bool left : {true, false}) {
        const CameraModel& camera = left ? rig.left_camera : rig.right_camera;
        const double depth_mm = (camera.device_from_rig * middle).z();
        for (int way = 0; way < kWays; ++way) {
            const CameraModel wrong = wrong_by(camera, way, depth_mm, scale);
            std::vector<Vector3d> moved;  // the reference places, as measured through the wrong camera
            for (const Reference& r : references)
                moved.push_back(-(r.from_pixels * (r.pixel_by_point[left ? 0 : 1].transpose() *
                                                   pixel_error(camera, wrong, r.p_in_rig))));
            Vector6 error = Vector6::Zero();
            for (const Seen& s : seen) {
                const auto k = static_cast<std::size_t>(s.sighting->marker);
                Vector2d pixel = s.pixel_by_point * (pose.linear() * moved[k]);
                if (s.sighting->left == left) pixel += pixel_error(camera, wrong, pose * markers[k].centre_in_patient);
                error -= s.twist_by_pixel * pixel;
            }
            C += error * error.transpose();
        }
    }
    return result;
}

}  // namespace planlight
