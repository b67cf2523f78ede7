#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "planning_io/plan/plan_import.h"
#include "planning_io/types/plan.h"

namespace planlight {

/// How many, and how large, what a person does not want to hurt may be.
struct RiskLimits {
    std::size_t structures = 50, triangles = 1000000;  ///< triangles: of one
    double least_across_mm = 1, most_across_mm = 600;  ///< one in metres is 0.02 "mm" across
    std::string space_option = "--risk-frame";         ///< by which a person says the space, as refusals call it
};

/// The risk structures of one file: the closed surface of an STL, PLY, OBJ, VTP or VTK file, named as the file without
/// its ending, or all solids of a DICOM RTSTRUCT, each named as its ROI.
///
/// Frame as of plans: said by the file or by `settings`. Refused (InputError, by name and number): an open surface,
/// none at all, other bounds than `limits`, a folder; a cut or garbled file is a DamagedFileError. `notes`: what was
/// left out, a sentence each, with the file's name.
std::vector<RiskStructure> read_risk_structures(const std::filesystem::path& file, const PlanImportSettings& settings,
                                                std::vector<std::string>& notes, const RiskLimits& limits = {});

/// Those of all the files into the plan, with their notes. Throws InputError where they are more than `limits` allow.
void append_risk_structures(PlanImport& plan, const std::vector<std::filesystem::path>& files,
                            const PlanImportSettings& settings, const RiskLimits& limits = {});

}  // namespace planlight
