#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "planning_io/plan/plan_import.h"
#include "planning_io/types/plan.h"
#include "planning_io/types/triangle_mesh.h"

namespace planlight {

/// The surface of one solid of an RT Structure Set: its closed contours on even, parallel slices, drawn into voxels of
/// 1 mm (contours within contours are holes), as `surface_of_mask` gives it. `roi` is its name, and needed when several
/// are solids. Slices without a contour are empty. Throws InputError, by name.
TriangleMesh read_roi_surface(const std::filesystem::path& file, const std::string& roi,
                              const PlanImportSettings& settings, std::vector<std::string>& notes);

/// Every solid of the set, named as its ROI, as `contour_solid` makes them. `notes`: ROIs that are no solids, and those
/// whose type says that they are no organ (the patient's outline, what is to be treated, a bolus ...), which are left
/// out, and gaps between contours. Throws InputError where none is.
std::vector<RiskStructure> read_roi_solids(const std::filesystem::path& file, const PlanImportSettings& settings,
                                           std::vector<std::string>& notes);

}  // namespace planlight
