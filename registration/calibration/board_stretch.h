#pragma once

#include <optional>
#include <string>
#include <vector>

#include "registration/calibration/calibrate_rig.h"

// A board that a printer made longer one way: every length of the patient would be, too.
namespace planlight {

/// How much longer than wide the board's squares seem to be, as a share; 0 unless both cameras say so alike. Cameras
/// have square pixels: what both see stretched is the board, as a printer's feed does it, and so would be every length
/// of the patient in one direction.
double board_stretch(const RigEstimate& rig);

std::string said_of_stretch(double stretch);

inline constexpr const char* kStretchRemedy =
    "Measure the board's width and its height over many squares; print it without scaling to the page, on another "
    "printer if need be, and capture again.";

/// A board printed longer one way and rolled between the poses contradicts itself as cameras do that were moved.
/// Refused as such where its height alone, left free, makes both cameras fit together as well as each by itself.
std::optional<Refusal> judge_stretch(const std::vector<PoseObservation>& poses, const BoardSpec& board,
                                     const BundleResult& cameras, const CalibrationSettings& settings);

}  // namespace planlight
