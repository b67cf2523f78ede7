#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "planning_io/types/point_cloud.h"
#include "planning_io/types/registration_result.h"
#include "planning_io/types/rig_state.h"
#include "registration/tracking/track_patient.h"

namespace planlight {

/// Which part of the plan is lit, as a person wishes it.
struct LitPart {
    std::set<std::size_t> hidden;               ///< items of the plan, neither lit nor looked for
    std::optional<std::size_t> item_of_moment;  ///< alone bright; empty: all are
    bool card = true;                           ///< nobody has looked at a landmark of this match yet
};

/// A match with all that it takes to go on with it in another session: T_ini, the rig as its scan found it, and the
/// markers at that scan.
struct KeptMatch {
    RegistrationResult registration;     ///< names its case and its rig
    std::vector<PatientMarker> markers;  ///< patient, mm
    std::string plan_hash;               ///< of the plan that was drawn
    bool confirmed = false;              ///< a person has looked at the match (verdict `ask`)
    std::string made_utc;
    LitPart lit;  ///< when it was kept
};

/// The MTCH chunk of a recording, and what stands in it. Throws InputError or DamagedFileError (`file`: for its words).
std::string text_of(const KeptMatch& match);
KeptMatch kept_match_of(const std::string& text, const std::filesystem::path& file);

/// What a kept match must agree with before light is drawn by it again.
struct ResumeSettings {
    double max_marker_off_mm = 0.5;   ///< of a marker against the others, and no less than four of its sigmas
    double max_motion_mm = 0.3;       ///< of any marker from the first picture of the short scan to its end
    double max_light_moved_mm = 1;    ///< at the plan's points, by where the short scan finds the projector
    double max_skin_off_mm = 1;       ///< of the plan's point that lies farthest off where the markers put it
    double max_more_residual_mm = 1;  ///< of the scanned skin, median, more than when it was matched
};

/// What the short scan found before a kept match was taken up again.
struct ResumeCheck {
    int markers = 0;           ///< of the match's, seen by both cameras
    double marker_off_mm = 0;  ///< of the one that lies farthest from where the others put it
    double moved_meanwhile_mm = 0;
    RigState rig;                          ///< against the rig as the match's scan found it
    double light_moved_mm = 0;             ///< see `ResumeSettings`; 0 where the scan does not tell
    std::size_t points = 0;                ///< of skin, scanned
    double residual_mm = 0;                ///< of these, median, from the skin where the match has it
    double skin_off_mm = 0, bound_mm = 0;  ///< of the plan's point that lies farthest off, and 95 % of the scan's error
    std::shared_ptr<const PointCloud> cloud;  ///< the scanned skin, rig
};

}  // namespace planlight
