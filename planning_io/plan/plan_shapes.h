#pragma once

#include <filesystem>

#include "planning_io/plan/plan_import.h"

namespace planlight {

/// A plan from VTP, VTK, PLY, OBJ or STL: polylines are osteotomy lines (closed where they end at their first point);
/// of an open surface its edges are, each closed. Files that `write_plan_vtp` wrote give every item back as it was. A
/// closed surface has no edge to cut along and is refused, as is a file that does not say SPACE=LPS or SPACE=RAS.
PlanImport read_shape_plan(const std::filesystem::path& file, const PlanImportSettings& settings);

/// Writes the plan as VTP (lines and points; SPACE=LPS as 3D Slicer reads it), with kind, name, description
/// ("diameter_mm=7"), axis and colour of each item as cell data.
void write_plan_vtp(const Plan& plan, const std::filesystem::path& file);

}  // namespace planlight
