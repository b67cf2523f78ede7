#pragma once

#include <Eigen/Core>
#include <vector>

namespace planlight {

/// Closed contours that are parallel at this many heights or more outline a solid (an organ, a tumour), not a cut.
inline constexpr std::size_t kSolidHeights = 3;

/// At how many heights over the plane of the first contour the contours lie, 0.1 mm apart at least; 0 without contours,
/// or when the first has no area.
std::size_t heights_of_contours(const std::vector<std::vector<Eigen::Vector3d>>& closed_contours);

}  // namespace planlight
