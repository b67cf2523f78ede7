#pragma once

#include <optional>
#include <string>

#include "planning_io/plan/plan_import.h"

namespace planlight {

/// What --frame and --accept-frame say, and the CT's own frame of reference (not given: there is no CT to check
/// against).
inline PlanImportSettings plan_settings(const std::string& frame, const std::string& accepted_uid,
                                        const std::optional<std::string>& uid_of_ct) {
    PlanImportSettings settings;
    if (!frame.empty()) settings.space = space_named(frame);
    settings.frame_of_reference_uid = accepted_uid.empty() ? uid_of_ct : std::optional(accepted_uid);
    return settings;
}

}  // namespace planlight
