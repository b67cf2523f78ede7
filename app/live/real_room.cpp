#include "app/live/real_room.h"

#include <fmt/format.h>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

GenicamSettings::Trigger trigger_of(RoomCamera::Trigger trigger) {
    switch (trigger) {
        case RoomCamera::Trigger::software:
            return GenicamSettings::Trigger::software;
        case RoomCamera::Trigger::line:
            return GenicamSettings::Trigger::line;
        case RoomCamera::Trigger::none:
            break;
    }
    return GenicamSettings::Trigger::none;
}

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

GenicamSettings genicam_settings(const RoomCamera& camera, const std::string& name) {
    GenicamSettings settings;
    settings.name = name;
    settings.device = camera.device;
    settings.trigger = trigger_of(camera.trigger);
    settings.line = camera.line;
    settings.pixel_format = camera.pixel_format;
    settings.exposure_ms = camera.exposure_ms;
    settings.gain = camera.gain;
    settings.frames_hz = camera.frames_hz;
    settings.region = camera.region;
    settings.transfer_ms = camera.transfer_ms;
    return settings;
}

RealRoom::RealRoom(const RoomFile& room, const RigCalibration& rig, Projector& projector)
    : room_(room), rig_(rig), projector_(projector) {
    check_size("the projector", projector.width(), projector.height(), rig.projector);
    auto left = std::make_unique<GenicamCamera>(genicam_settings(room.left, "left camera"), bell_, clock_);
    auto right = std::make_unique<GenicamCamera>(genicam_settings(room.right, "right camera"), bell_, clock_);
    check_size(left->name(), left->width(), left->height(), rig.left_camera);
    check_size(right->name(), right->width(), right->height(), rig.right_camera);
    check_serials(left->serial(), right->serial(), rig.serials);
    left_ = left.get();
    right_ = right.get();
    PairSettings pairs;
    pairs.most_apart = from_seconds(room.max_apart_ms / 1e3);
    cameras_ = std::make_unique<PairedCameras>(std::move(left), std::move(right), bell_, clock_, pairs);
}

std::vector<std::string> RealRoom::notes() const {
    std::vector<std::string> notes;
    for (const GenicamCamera* camera : {left_, right_})
        for (const std::string& note : camera->notes()) notes.push_back(camera->name() + ": " + note);
    return notes;
}

}  // namespace planlight
