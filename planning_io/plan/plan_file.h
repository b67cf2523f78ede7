#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "planning_io/types/plan.h"

namespace planlight {

/// Reads a plan from a file that says its own frame and units, or from a folder of such files: `import_plan` without
/// any help.
Plan read_plan(const std::filesystem::path& file_or_folder);

/// Throws InputError, by name, when a coordinate is not finite or a size is negative.
void check_plan_numbers(const Plan& plan, const std::filesystem::path& file);

/// What a file without names of its own calls its items: the file's name without its ending.
std::string plan_name_of(const std::filesystem::path& file);

/// Writes the plan as one .mrk.json that 3D Slicer opens (LPS, mm) and `read_plan` reads back value for value.
void write_plan(const Plan& plan, const std::filesystem::path& file);

/// XXH3-128 of what `write_plan` writes and of the risk structures, hex: two plans of the same hash show the same.
std::string hash_of(const Plan& plan);

/// Every point of the plan, ct, mm.
std::vector<Eigen::Vector3d> points_of(const Plan& plan);

}  // namespace planlight
