#pragma once

#include <filesystem>
#include <string>
#include <vector>

/// One struct of options and one function a command; each function gives the exit code of a run that was not refused.
namespace planlight {

using Path = std::filesystem::path;

struct PrepareOptions {
    Path volume, plan, out;
    std::string series_uid;
    std::string frame, accept_frame;  ///< of a plan that does not say its coordinate system; a DICOM frame of reference
    Path surface;                     ///< to project on, instead of the skin
    std::string surface_frame, segment;
    double threshold = 0;  ///< HU; 0 = found from the histogram
    double voxel_mm = 1;
    bool anonymous = false;  ///< no UID and no file name of the volume in the case folder
    bool replace = false, preview = false, json = false;
};
int run_prepare(const PrepareOptions& options);

struct PlanOptions {
    std::vector<Path> files;
    Path case_folder, volume, out;
    std::string series_uid, frame, accept_frame;
    bool json = false;
};
int run_plan(const PlanOptions& options);

struct PatternsOptions {
    Path out;
    int width = 1920, height = 1080, phase_steps = 8;
    double phase_period_px = 16;
    std::string set = "full";  ///< or "fast", "multi-frequency"
    bool columns_only = false;  ///< no rows
    bool json = false;
};
int run_patterns(const PatternsOptions& options);

struct BoardOptions {
    std::string board = "charuco 10x7 25 mm";
    Path out = "board";  ///< without ending
    bool json = false;
};
int run_board(const BoardOptions& options);

struct CalibrateOptions {
    Path captures, out = "rig.json";
    std::string board;
    std::string serial_left, serial_right, serial_projector;  ///< empty: as capture.json says
    bool json = false;
};
int run_calibrate(const CalibrateOptions& options);

struct CheckOptions {
    Path capture, rig, log;  ///< log empty: beside the rig file
    bool json = false;
};
int run_check(const CheckOptions& options);

struct SimulateOptions {
    Path volume, plan, out;
    std::string board;  ///< captures of a calibration board instead of a patient
    int poses = 15;
    std::string preset = "modern";
    unsigned seed = 1;
    int frames = 20;
    double speed_mm_s = 20;
    bool json = false;
};
int run_simulate(const SimulateOptions& options);
int run_simulate_board(const SimulateOptions& options);  ///< with `board` given

struct ScanOptions {
    Path capture, rig, out, raw_out;
    Path surface_out;               ///< the same points with triangles; empty: not wanted
    std::vector<Path> exposures;    ///< further captures of the same pose
    double max_movement_mm = 0.15;  ///< of the patient during the scan
    bool accept_movement = false, json = false;
};
int run_scan(const ScanOptions& options);

struct RegisterOptions {
    Path case_folder, cloud, out;
    Path pairs;             ///< landmarks: a check of the cloud's match, or, without a cloud, the match
    Path slicer_transform;  ///< to write; empty: not wanted
    Path certificate;       ///< page to write; empty: not wanted
    std::string unit = "mm";
    bool in_rig = false;
    std::vector<double> viewpoint_in_rig;  ///< 3 numbers, mm; empty: not said
    std::string icp = "signed-distance";
    unsigned seed = 1;
    bool json = false;
};
int run_register(const RegisterOptions& options);

struct TrackOptions {
    Path frames, rig, capture, out;
    bool json = false;
};
int run_track(const TrackOptions& options);

struct ProjectOptions {
    Path case_folder, rig, registration, poses, out;
    int frame = -1;  ///< of the poses; -1: the last
    bool confirmed = false, json = false;
};
int run_project(const ProjectOptions& options);

struct ProjectorOptions {
    Path recording, keep, out;       ///< `out`: projector.json, empty: not written; `keep`: folder for what is recorded
    std::string simulate;            ///< preset of the simulated room; empty: none
    std::vector<std::string> light;  ///< of the simulated room, NAME=NUMBER
    std::string part = "all", monitor, serial;
    unsigned seed = 1;
    double refresh_hz = 60, refresh_tolerance_hz = 0.1;
    double configured_delay_ms = -1;  ///< the delay in force; below 0: as the recording says
    bool identify = false, show = false;
    double frames_hz = 25;  ///< of the cameras that look while `show`s
    double seconds = 15;  ///< of `identify`
    bool json = false;
};
int run_projector(const ProjectorOptions& options);

struct ReviewOptions {
    Path case_folder, picture, registration, cloud;
    Path landmarks;              ///< table to click landmarks into; empty: not wanted
    std::string view = "after";  ///< before, after, error
    bool json = false;
};
int run_review(const ReviewOptions& options);

struct SessionOptions {
    Path case_folder, volume;
    Path keep;  ///< folder for every match; empty: CASE/registrations
    std::string preset = "paper", projector_monitor, operator_monitor;
    unsigned seed = 1;
    double speed_mm_s = 20;
    bool autoplay = false;
    double end_after_s = 0;  ///< wall time; 0 = until the window is closed
    Path screenshots;
    double light_delay_ms = -1;  ///< of the projector window; below 0: the default, or what `projector_file` says
    Path projector_file;         ///< projector.json of the monitor; empty: none
};
int run_session(const SessionOptions& options);

struct DemoOptions {
    Path volume = "/usr/share/doc/invesalius-examples/examples/Cranium.inv3";
    Path plan, out = "planlight-demo";
    std::string preset = "both";
    unsigned seed = 1;
    int seeds = 1, jobs = 1;
    bool headless = false, no_pictures = false, json = false;
};
int run_demo(const DemoOptions& options);

}  // namespace planlight
