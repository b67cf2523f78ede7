#include "app/commands/capture_conversion.h"

#include <fmt/format.h>

#include <algorithm>

#include "planning_io/types/error.h"

namespace planlight {

ScanCapture scan_capture_from(const CaptureFolder& folder, const std::filesystem::path& named) {
    ScanCapture capture;
    capture.stripes.width = folder.projector_width;
    capture.stripes.height = folder.projector_height;
    capture.stripes.phase_steps = folder.phase_steps;
    capture.stripes.phase_period_px = folder.phase_period_px;
    capture.stripes.rows = folder.rows;
    capture.stripes.inverse = folder.inverse;
    for (const auto& pattern : stripe_sequence(capture.stripes)) {
        const auto found = std::find(folder.names.begin(), folder.names.end(), pattern.name);
        if (found == folder.names.end())
            throw InputError(named, fmt::format("the picture of pattern \"{}\" is missing", pattern.name),
                             "Capture the whole sequence that `planlight patterns` writes.");
        const auto index = static_cast<std::size_t>(found - folder.names.begin());
        capture.left.push_back(folder.left.at(index));
        capture.right.push_back(folder.right.at(index));
    }
    capture.began = folder.began;
    capture.ended = folder.ended;
    return capture;
}

void check_sizes(const ScanCapture& capture, const RigCalibration& rig, const std::filesystem::path& folder) {
    const auto fits = [](const GrayImage& picture, const CameraModel& camera) {
        return picture.width == camera.width && picture.height == camera.height;
    };
    if (!fits(capture.left.front(), rig.left_camera) || !fits(capture.right.front(), rig.right_camera) ||
        capture.stripes.width != rig.projector.width || capture.stripes.height != rig.projector.height)
        throw InputError(folder, "the pictures or the projector have another size than the rig file says",
                         "Use the rig.json of the rig that this capture was made with.");
}

CaptureFolder capture_folder_from(const ScanCapture& capture) {
    CaptureFolder folder;
    folder.projector_width = capture.stripes.width;
    folder.projector_height = capture.stripes.height;
    folder.phase_steps = capture.stripes.phase_steps;
    folder.phase_period_px = capture.stripes.phase_period_px;
    folder.rows = capture.stripes.rows;
    folder.inverse = capture.stripes.inverse;
    for (const auto& pattern : stripe_sequence(capture.stripes)) folder.names.push_back(pattern.name);
    folder.left = capture.left;
    folder.right = capture.right;
    folder.began = capture.began;
    folder.ended = capture.ended;
    return folder;
}

}  // namespace planlight
