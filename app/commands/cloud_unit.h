#pragma once

#include <filesystem>
#include <string>

#include "planning_io/types/point_cloud.h"

namespace planlight {

/// A unit of a cloud's numbers: mm, cm, m, um or inch.
double unit_in_mm(const std::string& unit);

/// Throws InputError for a cloud that is under 50 mm or over 20 m across as it was read, when its numbers in another
/// unit would make it as large as a scan of a head (100 to 500 mm): the remedy names that unit. Stray points (1 % at
/// each end of each axis) do not count.
void check_unit(const PointCloud& cloud, const std::string& unit, const std::filesystem::path& file);

/// The same as a hint for a cloud that was not found on the patient and is over 1 m across, which may be a head in
/// another unit or a scan of the whole room. Empty when there is nothing to hint at.
std::string hint_of_unit(const PointCloud& cloud, const std::string& unit);

}  // namespace planlight
