#pragma once

#include <Eigen/Geometry>

#include "planning_io/types/rig_calibration.h"

namespace planlight::test {

/// Two cameras 300 mm apart that look inwards, and a projector between them; every number differs from its neighbours'.
inline RigCalibration example_rig() {
    const auto device = [](double x_mm, double toe_in) {
        CameraModel d{1440, 1080, 2400, 2401, 719.3, 541.1, -0.1, 0.05, 1e-4, -2e-4, 0.001};
        RigidTransform rig_from_device = RigidTransform::Identity();
        rig_from_device.translation().x() = x_mm;
        rig_from_device.linear() = Eigen::AngleAxisd(toe_in, Eigen::Vector3d::UnitY()).toRotationMatrix();
        d.device_from_rig = rig_from_device.inverse();
        return d;
    };
    return {device(-150, 0.15), device(150, -0.15), device(3, 0), "2026-01-02", 0.11, {}};
}

}  // namespace planlight::test
