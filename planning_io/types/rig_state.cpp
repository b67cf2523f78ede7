#include "planning_io/types/rig_state.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace planlight {
namespace {

constexpr std::array<double, kRigDevices> kSigma_px{0.1, 0.1, 0.25};

}  // namespace

CameraModel changed(CameraModel device, const DeviceChange& change) {
    device.device_from_rig = transform_from_twist(change.head<6>()) * device.device_from_rig;
    device.focal_x *= std::exp(change[6]);
    device.focal_y *= std::exp(change[6]);
    device.centre_x += change[7];
    device.centre_y += change[8];
    device.k1 += change[9];
    return device;
}

const char* text_of(RigDevice device) {
    return device == RigDevice::left_camera    ? "left camera"
           : device == RigDevice::right_camera ? "right camera"
                                               : "projector";
}

const CameraModel& device_of(const RigCalibration& rig, RigDevice device) {
    return device == RigDevice::left_camera    ? rig.left_camera
           : device == RigDevice::right_camera ? rig.right_camera
                                               : rig.projector;
}

CameraModel& device_of(RigCalibration& rig, RigDevice device) {
    return const_cast<CameraModel&>(device_of(static_cast<const RigCalibration&>(rig), device));
}

const char* text_of(RigState::Verdict verdict) {
    switch (verdict) {
        case RigState::Verdict::as_calibrated:
            return "as calibrated";
        case RigState::Verdict::corrected:
            return "corrected";
        case RigState::Verdict::not_trusted:
            return "not trusted";
        case RigState::Verdict::unknown:
            break;
    }
    return "unknown";
}

std::optional<Eigen::Vector3d> point_of_pixels(const RigCalibration& rig, const DevicePixels& pixels,
                                               const Eigen::Vector3d& near) {
    Eigen::Vector3d p = near;
    for (int round = 0; round < 10; ++round) {
        Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
        Eigen::Vector3d right = Eigen::Vector3d::Zero();
        for (std::size_t d = 0; d < kRigDevices; ++d) {
            Eigen::Matrix<double, 2, 3> J;
            const auto pixel = project(device_of(rig, static_cast<RigDevice>(d)), p, J);
            if (!pixel) return std::nullopt;
            const double weight = 1 / (kSigma_px[d] * kSigma_px[d]);
            normal += weight * J.transpose() * J;
            right += weight * J.transpose() * (pixels[d] - *pixel);
        }
        const Eigen::Vector3d step = normal.ldlt().solve(right);
        if (!step.allFinite()) return std::nullopt;
        p += step;
        if (step.squaredNorm() < 1e-8) return p;
    }
    return std::nullopt;
}

RigCalibration doubted(const RigCalibration& rig, const RigDoubt& doubt) {
    RigCalibration other = rig;
    for (std::size_t d = 0; d < kRigDevices; ++d) {
        CameraModel& device = device_of(other, static_cast<RigDevice>(d));
        device = changed(device, doubt.by[d]);
    }
    return other;
}

double hidden_light_mm(const RigState& state, const Eigen::Vector3d& p_in_rig) {
    DevicePixels pixels;
    for (std::size_t d = 0; d < kRigDevices; ++d) {
        const auto pixel = project(device_of(state.rig, static_cast<RigDevice>(d)), p_in_rig);
        if (!pixel) return 0;
        pixels[d] = *pixel;
    }
    double farthest = 0, squares = 0;
    for (const RigDoubt& doubt : state.doubts) {
        const auto there = point_of_pixels(doubted(state.rig, doubt), pixels, p_in_rig);
        if (!there) continue;
        const double off = (*there - p_in_rig).norm();
        if (doubt.sigma)
            squares += 4 * off * off;
        else
            farthest = std::max(farthest, off);
    }
    return std::sqrt(farthest * farthest + squares);
}

}  // namespace planlight
