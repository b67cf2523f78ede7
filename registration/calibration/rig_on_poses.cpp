#include "registration/calibration/rig_on_poses.h"

namespace planlight {

RigOnPoses rig_on_poses(const RigCalibration& rig, const std::vector<PoseObservation>& poses, const BoardSpec& board,
                        const Calibration& placed) {
    RigEstimate held;
    held.bend_mm = placed.bundle.rig.bend_mm;
    const std::array<const CameraModel*, 3> devices{&rig.left_camera, &rig.right_camera, &rig.projector};
    for (std::size_t d = 0; d < 3; ++d)
        if (present(*devices[d])) held.devices[d] = *devices[d];
    // By the left camera, which both rigs have.
    const RigidTransform rig_from_placed =
        rig.left_camera.device_from_rig.inverse() * placed.device(DeviceName::left_camera)->device_from_rig;
    for (const auto& pose : placed.bundle.rig.rig_from_board)
        held.rig_from_board.push_back(pose ? std::optional(rig_from_placed * *pose) : std::nullopt);
    BundleSettings settings;
    settings.rig_fixed = true;
    const BundleResult judged = adjust_bundle(poses, board, held, settings);
    RigOnPoses result;
    result.rms_px = judged.rms_px;
    for (std::size_t d = 0; d < 3; ++d)
        if (const std::size_t all = judged.used[d] + judged.left_out[d]; all > 0)
            result.left_out[d] = static_cast<double>(judged.left_out[d]) / static_cast<double>(all);
    return result;
}

}  // namespace planlight
