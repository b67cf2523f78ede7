#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "planning_io/types/triangle_mesh.h"

namespace planlight {

/// The surface of a solid that an observer outlined slice by slice, for distances to it: nothing that was outlined may
/// be lost, and where the outlines leave a choice the solid is the larger one.
///
/// - `loops`: closed, parallel contours, ct, mm, in any order.
/// - A contour fills half the way to the next one over and under it that overlaps it, up to three times the usual gap
///   between slices; beyond that, and at its ends, half a usual gap. Uneven slices and one that was left out leave no
///   hole.
/// - A contour that lies wholly within another one is a hole; those that cross or stand twice are one.
/// - Drawn into voxels of 0.25 mm (larger where a connected part needs more than eight million of them), and what is
///   thinner than three of these is drawn three wide, so that it is not smoothed away.
///
/// Parts that are not connected are pieces of the mesh. `notes`: gaps that were left. Throws InputError with `file` and
/// `name`.
TriangleMesh contour_solid(std::vector<std::vector<Eigen::Vector3d>> loops, const std::string& name,
                           const std::filesystem::path& file, std::vector<std::string>& notes);

/// Axes (columns) with z across the plane of the first loop that has an area.
Eigen::Matrix3d axes_of_contours(const std::vector<std::vector<Eigen::Vector3d>>& loops);

}  // namespace planlight
