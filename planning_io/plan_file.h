#pragma once

#include <filesystem>
#include <vector>

#include "planning_io/types/plan.h"

namespace planlight {

/// Reads a plan from one 3D Slicer markups file (.mrk.json, schema 1.0.x) or from every .mrk.json in a folder.
///
/// Line = trajectory (first point entry, second target); Curve and ClosedCurve = osteotomy line; Fiducial = boreholes
/// (diameter, depth and axis from the point's description "diameter_mm=7 depth_mm=6 axis=z"; see the room's README);
/// Plane = cut plane. Coordinate system exactly "LPS" or "RAS", units mm (or um): anything else is refused with InputError.
Plan read_plan(const std::filesystem::path& file_or_folder);

/// Writes the plan as one .mrk.json that 3D Slicer opens (LPS, mm) and `read_plan` reads back value for value.
void write_plan(const Plan& plan, const std::filesystem::path& file);

/// Every point of the plan, ct, mm.
std::vector<Eigen::Vector3d> points_of(const Plan& plan);

}  // namespace planlight
