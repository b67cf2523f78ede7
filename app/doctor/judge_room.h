#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "planning_io/case/light_file.h"
#include "planning_io/types/rig_calibration.h"
#include "projection/monitor/monitors_kept_on.h"
#include "projection/monitor/projector_window.h"
#include "registration/calibration/check_drift.h"

// What the doctor says of a room, by figures alone: whoever measured them, each rule is a function of values.
namespace planlight {

/// good: nothing to do. look: it may be used, and a person should know. stop: it must not be used like this.
enum class Health { good, look, stop };

/// As `doctor --json` says it: "good", "look", "stop".
const char* text_of(Health health);

/// One thing that was looked at.
struct DoctorLine {
    std::string subject;  ///< "left camera, rate"
    Health health = Health::good;
    std::string said;    ///< what was found, with its figures
    std::string remedy;  ///< a sentence; empty when good
};

/// The worst of all; good where there is none.
Health worst_of(const std::vector<DoctorLine>& lines);

/// What can be told of a camera without any light. Counts are of the time that it was watched.
struct CameraFigures {
    std::string side;    ///< "left camera"
    std::string serial;  ///< empty: it tells none
    int width = 0, height = 0;
    std::optional<double> asked_hz;  ///< of room.json
    double rate_hz = 0;              ///< whole frames
    std::size_t received = 0, incomplete = 0, repeated = 0;
    bool own_clock = false;  ///< it stamps its frames
    double clock_drift = 0;  ///< seconds a second against this machine's; positive: it runs slow
    double clock_sigma_ms = 0;
    std::size_t clock_jumps = 0;
    std::vector<std::string> notes;  ///< what it does by itself
};

/// Serial and resolution against the rig file (null: there is none to compare with), rate, loss, clock, its notes.
std::vector<DoctorLine> judge_camera(const CameraFigures& camera, const std::string& calibrated_serial,
                                     const CameraModel* calibrated);

/// The link of a camera on the network, and what the system allows.
struct NetworkFigures {
    std::string side;
    int packet_bytes = 0;  ///< 0: not on the network
    std::size_t frame_bytes = 0;
    std::optional<std::size_t> buffer_bytes_max;  ///< net.core.rmem_max; empty: not told
};

std::vector<DoctorLine> judge_network(const NetworkFigures& network);

/// Which exposures of both cameras were one, while they were watched.
struct PairFigures {
    std::size_t left = 0, right = 0, pairs = 0;  ///< whole frames, and pairs of them
    double apart_ms = 0;                         ///< right less left, median
    double allowed_ms = 0;                       ///< apart
    std::string problem, remedy;                 ///< why there are no pairs; empty where there are
};

std::vector<DoctorLine> judge_pairs(const PairFigures& pairs);

/// How light and lens suit a camera, by one scan.
struct PictureFigures {
    std::string side;
    double lit_share = 0;                ///< of the picture, by the projector
    double saturated_share = 0;          ///< of what is lit
    double brightest_lit_grey = 0;       ///< 95 % of what is lit is darker under white
    std::optional<double> fringe_share;  ///< modulation of the finest fringes over that of black and white, median
    double fringe_period_px = 16;        ///< of the projector
};

/// Exposure and focus. Focus is a blur: camera and projector together, in the projector's pixels.
std::vector<DoctorLine> judge_picture(const PictureFigures& picture);

/// One standard deviation of the blur that leaves so much of a fringe; empty for none or all of it.
std::optional<double> blur_of_fringe(double share, double period_px);

/// The projector's monitor, as the window system lists it.
struct MonitorFigures {
    std::string wanted;            ///< of room.json
    std::optional<Monitor> found;  ///< empty: there is none of that name
    ProjectorFacts measured;       ///< projector.json; empty fields were not measured
    bool covered = false;          ///< a window of exactly its size stands on it and stays there
    std::string problem, remedy;   ///< why not
    /// How much of the monitor the desktop lights by itself, before any window of ours; empty: not known.
    std::optional<double> desktop_lit;
    bool composited = false;  ///< a compositor draws the desktop's windows
    bool wayland = false;
};

std::vector<DoctorLine> judge_monitor(const MonitorFigures& monitor, const CameraModel& calibrated_projector);

/// From the order to the light, by a quick flash.
struct DelayFigures {
    std::string problem, remedy;           ///< why it was not measured; empty where it was
    double measured_ms = 0, sigma_ms = 0;  ///< from the return of `show`
    std::optional<double> told_ms;         ///< projector.json; empty: there is none
    std::optional<double> right_later_ms;  ///< the same light in the right camera's frames less in the left's
    double frame_interval_ms = 0;
};

std::vector<DoctorLine> judge_delay(const DelayFigures& delay);

/// One scan of anything against the rig file, and how old that is.
std::vector<DoctorLine> judge_rig(const DriftCheck& check, std::optional<double> age_days);

/// The computer.
struct MachineFigures {
    std::optional<std::uint64_t> free_bytes;  ///< where the case is kept
    std::string folder;
    std::string gl_renderer;  ///< empty: no OpenGL
    std::string gl_problem;
    std::vector<std::string> governors;                ///< of the processors, each once; empty: not told
    std::string gl_remedy = {};                        ///< of `gl_problem`
    std::optional<MonitorsDarkAfter> dark_after = {};  ///< empty: there is no display
    bool realtime_priority = false;                    ///< the projector process would get it
};

std::vector<DoctorLine> judge_machine(const MachineFigures& machine);

}  // namespace planlight
