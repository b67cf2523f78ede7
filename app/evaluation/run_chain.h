#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "app/evaluation/distribution.h"
#include "app/evaluation/measure_overlay.h"
#include "app/session.h"
#include "planning_io/types/volume.h"

namespace planlight {

/// One room of the evaluation, by `planlight demo` and by tests.
struct ChainSettings {
    simulation::Preset preset = simulation::Preset::modern;
    unsigned seed = 1;
    int rest_updates = 12;                              ///< tracked updates with the head at rest
    int moving_updates = 40;                            ///< with the head moving
    int measured_updates = 12;                          ///< of the moving ones, evenly spread, whose light is measured
    double speed_mm_s = 20;                             ///< peak speed of the moving head
    Instant computing = std::chrono::milliseconds(10);  ///< simulated time from seeing to showing
    std::function<void(RigCalibration&)> spoil_calibration;  ///< for tests: a wrong rig file; empty leaves it right
};

/// What a watcher (windows, pictures for the report) is shown while the chain runs. Any may be empty.
struct ChainWatcher {
    std::function<void(const std::string& stage, double share)> progress;
    std::function<void(const Session&, const simulation::SimulatedRig&)> scanned, registered;
    std::function<void(const Session&, const simulation::SimulatedRig&, const Session::Update&,
                       const std::string& stage)>
        updated;
    std::function<Projector&(Projector& simulated)> wrap_projector;  ///< e.g. to show the light in a window as well
};

/// All figures of one run in one simulated room, against the simulator's truth, refusals counted.
struct ChainFigures {
    std::string preset;
    unsigned seed = 0;
    std::string refused;  ///< the stage and the reason when the chain stopped early; empty when it ran through

    int patterns = 0;
    double scan_simulated_s = 0;  ///< light on the patient, first to last pattern
    std::size_t decoded_left = 0, decoded_right = 0;
    std::map<std::string, std::size_t> removed;  ///< scan points by reason
    std::size_t scan_points = 0;
    std::vector<double> scan_error_mm;  ///< absolute, clean cloud against the true skin
    double scan_bias_mm = 0;            ///< median, signed; positive outside

    std::optional<RegistrationResult> registration;
    bool initial_match_right = false;  ///< before the ICP: plan points within 10 mm, turned less than 10 degrees
    double initial_error_mm = 0;
    std::vector<double> tre_mm;  ///< at every plan point (targets included)

    std::vector<double> tre_of_bound;  ///< the same / the 95 % bound that was predicted there

    OverlayErrors at_rest, moving;
    /// The same light as the product's own CHECK measured it: stretches of stroke beside their place, signs dropped.
    std::vector<double> measured_rest_mm, measured_moving_mm;
    int rest_dark = 0, moving_dark = 0;  ///< updates that gave no light
    std::map<std::string, int> dark_reasons;
    std::vector<double>
        tracking_error_mm;  ///< plan points: T_global of the frame against the truth, at rest and moving

    int lost_marker_updates = 0, lost_marker_lit = 0;  ///< one marker covered: must go on
    int too_few_updates = 0, too_few_lit = 0;          ///< two markers left: must be dark

    std::map<std::string, double> stage_s;  ///< the product's own work per stage
    std::vector<double> update_s;           ///< the product's own work per tracked update
};

/// Runs scan, match, track and draw in a simulated room and measures everything against its truth.
ChainFigures run_chain(const Volume& volume, const Case& the_case, const CaseDrawing& drawing,
                       const ChainSettings& settings, const ChainWatcher& watcher = {});

/// "paper" or "modern", as `--preset` takes it.
std::string name_of(simulation::Preset preset);

}  // namespace planlight
