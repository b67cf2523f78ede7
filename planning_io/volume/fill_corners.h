#pragma once

#include <functional>
#include <vector>

#include "planning_io/types/volume.h"

namespace planlight {

/// Marks of the pixels of a picture that hold what `wanted` says and are joined to its edge through others like them.
std::vector<char> joined_to_edge(int columns, int rows, const std::function<bool(std::size_t)>& wanted);

/// Of a volume in HU, slice by slice along its third axis: values of exactly 0 that are joined to the picture's edge,
/// and more than a few, are made air (no scanner measures water to the last digit outside of a head), and that is
/// noted.
void fill_corners(Volume& volume);

}  // namespace planlight
