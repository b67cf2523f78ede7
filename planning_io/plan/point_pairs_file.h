#pragma once

#include <filesystem>
#include <vector>

#include "planning_io/types/point_pair.h"

namespace planlight {

/// Landmarks as a table with commas: a line `# SPACE=LPS` (or RAS: of the ct columns), the line
/// `name,ct_x,ct_y,ct_z,rig_x,rig_y,rig_z`, then a landmark a line, mm. Throws InputError for a table without its
/// space, with other columns, a number that is none or beyond 5 m, and for a name that is used twice.
std::vector<PointPair> read_point_pairs(const std::filesystem::path& file);

/// The same table in LPS, to a hundredth of a millimetre. Throws InputError for a name with a comma or a line's end in
/// it.
void write_point_pairs(const std::vector<PointPair>& pairs, const std::filesystem::path& file);

}  // namespace planlight
