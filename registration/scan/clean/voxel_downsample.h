#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace planlight {

/// Indices of at most `max_points` of the points, evenly spread over the surface: one per cube of a grid whose edge is
/// the smallest that leaves few enough (to 2 %). In ascending order.
std::vector<std::size_t> voxel_downsample(const std::vector<Eigen::Vector3f>& points, std::size_t max_points);

}  // namespace planlight
