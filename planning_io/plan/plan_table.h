#pragma once

#include <filesystem>
#include <string>

#include "planning_io/plan/plan_import.h"

namespace planlight {

/// Trajectories, one a line, from a table with commas, semicolons or tabs whose first line names the columns: `name`,
/// the entry
/// (`ex ey ez` or `entry_x entry_y entry_z`), the target (`tx ty tz` or `target_x target_y target_z`), optional
/// `diameter_mm`. Lines "# SPACE=LPS" (or RAS) and "# units=um" before it; mm when no unit is said. Other columns are
/// left out, and noted.
PlanImport read_trajectory_table(const std::string& content, const std::filesystem::path& file,
                                 const PlanImportSettings& settings);

}  // namespace planlight
