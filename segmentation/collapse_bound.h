#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

namespace planlight {

/// How far the surface moves at most when the inner vertex `v` of a ring of triangles is pulled onto ring[target]:
/// every point of the old triangles has a partner on the new ones within this distance, and every point of the new ones
/// on the old.
///
/// Both fans over the ring are seen along their mean normal, where each covers the ring's polygon once; points above
/// each other are partners. Between the crossings of the two fans' edges both are flat, so the greatest distance is at
/// `v` or at a crossing (successive mappings, Cohen, Manocha & Olano 1997). Empty when one fan does not cover the
/// polygon once from any such view: then nothing is promised. The ring runs counter-clockwise seen from outside.
std::optional<double> collapse_bound(const Eigen::Vector3d& v, std::span<const Eigen::Vector3d> ring,
                                     std::size_t target);

}  // namespace planlight
