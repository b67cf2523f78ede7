#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "app/report/calibration_report.h"
#include "planning_io/types/rig_calibration.h"

namespace planlight {

/// What `planlight calibrate` was asked for.
struct CalibrateOptions {
    std::filesystem::path captures, out = "rig.json", pdf;
    std::string board;
    std::string serial_left, serial_right, serial_projector;  ///< empty: as capture.json says
    bool json = false;
    // With a board in somebody's hands, in a room of real devices.
    bool live = false, headless = false;
    std::filesystem::path room, keep_captures;  ///< `keep_captures`: empty, the pictures are not kept
    std::filesystem::path screenshots;          ///< of the window, for the pages and to look at; empty: none
    std::string operator_monitor;
    std::string language, theme;  ///< of the window; empty: the site's
    std::string keep = "ask";     ///< the new rig: ask, yes, no
    int most_poses = 12;
    double good_enough_mm = 0.1;
};

int run_calibrate_live(const CalibrateOptions& options);

/// Page and figures beside the rig file: "rig-calibration.html" and ".json" for "rig.json".
struct CalibrationFiles {
    std::filesystem::path page, figures;
};
CalibrationFiles calibration_files(const std::filesystem::path& rig);

/// Both, and the PDF where one is wanted. Gives the figures as they were written.
std::string write_calibration(const CalibrationReport& report, const std::filesystem::path& rig,
                              const std::filesystem::path& pdf);

/// The calibration that this one would take the place of, if it can be read.
std::optional<RigCalibration> previous_rig(const std::filesystem::path& file);

/// "rig-new.json" for "rig.json" and "-new", or "rig-new-2.json" and on where it is there.
std::filesystem::path unused(const std::filesystem::path& file, const std::string& end);

/// A rig that worked is never written over: what is there is copied to NAME-before.json, or NAME-before-2.json and on.
void keep_previous_rig(const std::filesystem::path& file);

}  // namespace planlight
