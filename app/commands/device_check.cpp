#include "app/commands/device_check.h"

#include <fmt/format.h>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

struct Device {
    const char* name;
    std::string DeviceSerials::*serial;
    CameraModel RigCalibration::*model;
};
constexpr Device kDevices[] = {{"left camera", &DeviceSerials::left_camera, &RigCalibration::left_camera},
                               {"right camera", &DeviceSerials::right_camera, &RigCalibration::right_camera},
                               {"projector", &DeviceSerials::projector, &RigCalibration::projector}};

bool has_size(const CameraModel& model, int width, int height) {
    return model.width == width && model.height == height;
}

void check_size(const Device& device, int width, int height, const RigCalibration& rig,
                const std::filesystem::path& folder) {
    const CameraModel& model = rig.*device.model;
    if (!present(model) || has_size(model, width, height)) return;
    const std::string problem = fmt::format("{}: the {} has {} x {} pixels here and {} x {} in the rig file",
                                            folder.string(), device.name, width, height, model.width, model.height);
    if (device.model == &RigCalibration::left_camera && has_size(rig.right_camera, width, height))
        throw CheckFailedError(problem, "It is the right camera's size: exchange the left and right pictures.");
    if (has_size(model, height, width))
        throw CheckFailedError(problem, "Turn its pictures by 90 degrees, as they were when the rig was calibrated.");
    throw CheckFailedError(
        problem,
        "Set the device to the resolution it was calibrated at, use the rig.json of this rig, or calibrate again.");
}

}  // namespace

CaptureFolder read_capture_of(const RigCalibration& rig, const std::filesystem::path& folder, const ReadCapture& how) {
    CaptureFolder capture = read_capture(folder, how);
    for (const Device& device : kDevices) {
        const std::string &here = capture.serials.*device.serial, &calibrated = rig.serials.*device.serial;
        if (here.empty() || calibrated.empty() || here == calibrated) continue;
        throw CheckFailedError(
            fmt::format("{}: was captured with the {} {}, and the rig file is of {}{}", folder.string(), device.name,
                        here, calibrated, rig.made_on.empty() ? "" : " (calibrated " + rig.made_on + ")"),
            "Use the rig.json of this rig, put the calibrated device back, or calibrate again.");
    }
    check_size(kDevices[0], capture.left.front().width, capture.left.front().height, rig, folder);
    if (!capture.right.empty())
        check_size(kDevices[1], capture.right.front().width, capture.right.front().height, rig, folder);
    check_size(kDevices[2], capture.projector_width, capture.projector_height, rig, folder);
    return capture;
}

DeviceSerials joined_serials(DeviceSerials given, const DeviceSerials& said, const std::filesystem::path& folder) {
    for (const Device& device : kDevices) {
        std::string& serial = given.*device.serial;
        const std::string& other = said.*device.serial;
        if (!serial.empty() && !other.empty() && serial != other)
            throw InputError(folder, fmt::format("names the {} {}, and it was {} before", device.name, other, serial),
                             "Capture all poses with the same devices, and give their own serials.");
        if (serial.empty()) serial = other;
    }
    return given;
}

}  // namespace planlight
