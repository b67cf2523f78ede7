#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/report/document.h"
#include "registration/calibration/calibrate_rig.h"

namespace planlight {

/// A calibration that was not refused, with what it was made from.
struct CalibrationReport {
    const Calibration& calibration;
    const std::vector<PoseObservation>& poses;
    BoardSpec board;
    std::string made_on;               ///< ISO 8601
    std::filesystem::path rig_file;    ///< empty: not a whole rig
    std::vector<std::string> changes;  ///< since the calibration before
    DeviceSerials serials;
};

/// Baseline, and how far the projector moved against the cameras, one sentence each.
std::vector<std::string> changes_since(const RigCalibration& before, const RigCalibration& now);

/// A few lines for the terminal.
std::string calibration_summary(const CalibrationReport& report);

/// Every figure, the devices in the words of rig.json, and their standard deviations.
std::string calibration_json(const CalibrationReport& report);

/// Verdict, figures, the predicted error over the working volume, where the board was in each picture.
Document calibration_document(const CalibrationReport& report);

/// The predicted error as pictures, one a depth, nearest first: dark blue 0, green half of `full_scale_mm`, red all of
/// it or more; grey not seen.
std::vector<RgbImage> volume_pictures(const VolumeError& volume, double full_scale_mm);

}  // namespace planlight
