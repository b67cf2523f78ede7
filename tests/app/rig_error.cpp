#include "tests/app/rig_error.h"

#include "registration/calibration/volume_error.h"

namespace planlight::test {

using Eigen::Vector3d;

RigError rig_error(const RigCalibration& found, const RigCalibration& truth, const std::vector<Vector3d>& points) {
    RigEstimate rig;
    rig.devices = {found.left_camera, found.right_camera, found.projector};
    const RigidTransform found_from_true =
        found.left_camera.device_from_rig.inverse() * truth.left_camera.device_from_rig;
    std::vector<Vector3d> placed, there;
    RigError error;
    for (const Vector3d& p : points) {
        const auto left = project(truth.left_camera, p), right = project(truth.right_camera, p),
                   lit = project(truth.projector, p);
        if (!left || !right || !lit || !in_picture(truth.left_camera, *left) ||
            !in_picture(truth.right_camera, *right) || !in_picture(truth.projector, *lit))
            continue;
        const auto q = triangulate_pixels(rig, {*left, *right, std::nullopt}, kScanSigma_px, found_from_true * p);
        if (!q) continue;
        placed.push_back(*q);
        there.push_back(p);
        if (const auto sent = project(found.projector, *q))
            error.light_mm.push_back((truth.projector.device_from_rig * p).z() / truth.projector.focal_x *
                                     (*sent - *lit).norm());
    }
    if (placed.size() < 3) return {};
    Eigen::Matrix3Xd a(3, placed.size()), b(3, placed.size());
    for (std::size_t i = 0; i < placed.size(); ++i) {
        a.col(static_cast<Eigen::Index>(i)) = placed[i];
        b.col(static_cast<Eigen::Index>(i)) = there[i];
    }
    const RigidTransform true_from_found = fit_rigid_transform(a, b);
    for (std::size_t i = 0; i < placed.size(); ++i)
        error.points_mm.push_back((true_from_found * placed[i] - there[i]).norm());
    return error;
}

void add_board_points(const RigidTransform& rig_from_board, std::vector<Vector3d>& points) {
    for (double x = 25; x < 250; x += 25)
        for (double y = 25; y < 175; y += 25) points.push_back(rig_from_board * Vector3d(x, y, 0));
}

}  // namespace planlight::test
