#include "registration/scan/triangulate/point_covariance.h"

#include <Eigen/LU>

#include "registration/scan/triangulate/triangulate_parts.h"

namespace planlight {
namespace {

void add_information(const CameraModel& device, const Eigen::Vector3d& p, double sigma_px,
                     Eigen::Matrix3d& information) {
    Eigen::Matrix<double, 2, 3> by_point;
    if (device.width < 1 || !project(device, p, by_point)) return;
    information += by_point.transpose() * by_point / (sigma_px * sigma_px);
}

}  // namespace

Eigen::Matrix3d expected_covariance(const Eigen::Vector3d& p_in_rig, const RigCalibration& rig,
                                    Triangulation::Seen seen, const TriangulationSettings& settings) {
    using Seen = Triangulation::Seen;
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero(), shape = information;
    if (seen != Seen::right_only) add_information(rig.left_camera, p_in_rig, settings.camera_sigma_px, information);
    if (seen != Seen::left_only) add_information(rig.right_camera, p_in_rig, settings.camera_sigma_px, information);
    add_information(rig.projector, p_in_rig, settings.projector_sigma_px, information);
    bool determined = false;
    information.computeInverseWithCheck(shape, determined, 1e-12);
    return determined ? shape : Eigen::Matrix3d::Zero();
}

Eigen::Matrix3d point_covariance(const Eigen::Vector3d& p_in_rig, const RigCalibration& rig, double worst_sigma_mm,
                                 Triangulation::Seen seen, const TriangulationSettings& settings) {
    const Eigen::Matrix3d shape = expected_covariance(p_in_rig, rig, seen, settings);
    const double worst = worst_sigma(shape);
    if (!(worst > 0)) return Eigen::Matrix3d::Zero();
    return shape * (worst_sigma_mm * worst_sigma_mm / (worst * worst));
}

}  // namespace planlight
