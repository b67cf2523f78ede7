#pragma once

#include <Eigen/Core>
#include <vector>

#include "planning_io/types/point_cloud.h"

namespace planlight {

/// The points of one 5 mm cell, as one small piece of surface.
struct CloudCell {
    Eigen::Vector3f position, normal;  ///< means, in rig; the normal of unit length, zero where it is not defined
    int points = 0;
    bool stray = false;         ///< few neighbours, or off their surface
    int piece = -1;             ///< index of the piece; -1: stray
    std::vector<int> touching;  ///< cells of the same surface next to it, over creases too; no strays
};

/// A scan as the smooth pieces it consists of.
///
/// Cells next to each other are joined where one lies in the other's plane: a step in depth (cloth behind a face) cuts.
/// A hollow crease cuts as well: things that lie on others meet them so (Stein et al. 2014, local convexity), while
/// ridges belong to one thing.
struct CloudPieces {
    std::vector<CloudCell> cells;
    std::vector<int> cell_of_point;  ///< per point of the cloud; -1: not finite, or far away
    std::vector<int> piece_cells;    ///< how many cells each piece has, largest first
    std::size_t stray_points = 0, finite_points = 0;
};

/// The cloud needs normals; without them everything is a stray.
CloudPieces cloud_pieces(const PointCloud& cloud);

}  // namespace planlight
