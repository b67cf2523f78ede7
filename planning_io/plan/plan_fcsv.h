#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "planning_io/plan/plan_import.h"

namespace planlight {

/// Points of 3D Slicer's older lists (.fcsv), versions 4.x and 5.x and that of Slicer 3: one borehole a point, as in a
/// Fiducial markup. `# CoordinateSystem =` 0 or RAS, 1 or LPS; 2 (voxels) is refused. A list of Slicer 3 is RAS by
/// definition.
PlanImport read_fcsv(const std::string& content, const std::filesystem::path& file, const PlanImportSettings& settings);

/// The fields of one line, "quoted" where they hold the separator, "" for a quote. Empty fields are kept.
std::vector<std::string> split_fields(std::string_view line, char separator);

/// A whole field as a finite number, with a point, whatever the locale. Empty when it is anything else.
std::optional<double> number_in(std::string_view field);

}  // namespace planlight
