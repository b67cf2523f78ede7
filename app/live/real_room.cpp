#include "app/live/real_room.h"

#include <fmt/format.h>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

void check_size(const std::string& device, int width, int height, const CameraModel& model) {
    if (width == model.width && height == model.height) return;
    throw CheckFailedError(fmt::format("{} has {} x {} pixels, and was calibrated with {} x {}", device, width, height,
                                       model.width, model.height),
                           "Set its resolution or region back, or calibrate the rig anew.");
}

void check_serials(const std::string& left, const std::string& right, const DeviceSerials& calibrated) {
    if (calibrated.left_camera.empty() || calibrated.right_camera.empty()) return;
    if (left == calibrated.right_camera && right == calibrated.left_camera)
        throw CheckFailedError("left and right camera are exchanged against the rig file",
                               "Exchange their devices in room.json.");
    for (const auto& [side, is, was] :
         {std::tuple{"left", left, calibrated.left_camera}, std::tuple{"right", right, calibrated.right_camera}})
        if (is != was)
            throw CheckFailedError(
                fmt::format("the {} camera is {}, and the rig was calibrated with {}", side, is, was),
                "Connect that camera, or calibrate the rig anew.");
}

}  // namespace

void check_devices(const RoomCameras& cameras, const Projector& projector, const RigCalibration& rig) {
    check_size("the projector", projector.width(), projector.height(), rig.projector);
    const Camera &left = cameras.left(), &right = cameras.right();
    check_size(left.name(), left.width(), left.height(), rig.left_camera);
    check_size(right.name(), right.width(), right.height(), rig.right_camera);
    // A recording need not say which cameras it was.
    if (!cameras.recorded() || !left.serial().empty()) check_serials(left.serial(), right.serial(), rig.serials);
}

RealRoom::RealRoom(const RoomFile& room, const RigCalibration& rig, Projector* projector, const RoomProgress& progress)
    : room_(room),
      rig_(rig),
      projector_(projector),
      cameras_(room, clock_, progress),
      recorded_projector_(cameras_.recorded_projector(clock_, projector)) {
    if (!projector_ && !recorded_projector_) throw no_projector();
    check_devices(cameras_, this->projector(), rig);
}

}  // namespace planlight
