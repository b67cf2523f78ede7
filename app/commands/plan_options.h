#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "planning_io/plan/plan_import.h"
#include "planning_io/surface/risk_structure_file.h"

namespace planlight {

/// What --frame and --accept-frame say, and the CT's own frame of reference (not given: there is no CT to check
/// against) and whose it is.
inline PlanImportSettings plan_settings(const std::string& frame, const std::string& accepted_uid,
                                        const std::optional<std::string>& uid_of_ct,
                                        const SeriesIdentity& volume = {}) {
    PlanImportSettings settings;
    if (!frame.empty()) settings.space = space_named(frame);
    settings.frame_of_reference_uid = uid_of_ct;
    settings.accepted_frame_uid = accepted_uid;
    settings.volume = volume;
    return settings;
}

/// Risk structures into the plan: their frame is `risk_frame`, or that of the plan's `said` where it is empty.
inline void add_risk_structures(PlanImport& plan, const std::vector<std::filesystem::path>& files,
                                const std::string& risk_frame, PlanImportSettings said) {
    RiskLimits limits;
    if (!risk_frame.empty())
        said.space = space_named(risk_frame);
    else if (said.space)
        limits.space_option = "--frame";
    append_risk_structures(plan, files, said, limits);
}

}  // namespace planlight
