#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "planning_io/types/volume.h"

namespace planlight {

/// Shape of a voxel array; i runs fastest. A gantry tilt is not seen here: radii are along the voxel axes.
struct VoxelGrid {
    std::array<int, 3> size{0, 0, 0};
    Eigen::Vector3d spacing_mm{1, 1, 1};

    std::size_t row() const { return static_cast<std::size_t>(size[0]); }
    std::size_t slab() const { return row() * static_cast<std::size_t>(size[1]); }
    std::size_t count() const { return slab() * static_cast<std::size_t>(size[2]); }
    double voxel_ml() const { return spacing_mm.prod() / 1000; }
};

/// The volume's size and spacing, without its place.
VoxelGrid grid_of(const Volume& volume);

using Mask = std::vector<std::uint8_t>;

/// Voxels within `radius_mm` (Euclidean, between centres) of a voxel whose value is `target`. Outside the array is
/// nothing.
Mask within(const Mask& mask, std::uint8_t target, const VoxelGrid& grid, double radius_mm);

/// Ball morphology. The array's border neither erodes nor feeds: a body cut by the end of the volume stays whole there.
Mask erode(const Mask& mask, const VoxelGrid& grid, double radius_mm);

/// By a ball of `radius_mm`, whatever the spacing.
Mask dilate(const Mask& mask, const VoxelGrid& grid, double radius_mm);

/// Dilation, then erosion, in a space that is empty beyond the array: the dome of a head cut by the last slice stays
/// itself.
Mask close(const Mask& mask, const VoxelGrid& grid, double radius_mm);

/// Calls `visit(neighbour_index)` for the up to six face neighbours.
template <class Visit>
void for_face_neighbours(const VoxelGrid& grid, std::size_t index, Visit&& visit) {
    const std::size_t row = grid.row(), slab = grid.slab();
    const std::size_t i = index % row, j = index / row % static_cast<std::size_t>(grid.size[1]), k = index / slab;
    if (i > 0) visit(index - 1);
    if (i + 1 < row) visit(index + 1);
    if (j > 0) visit(index - row);
    if (j + 1 < static_cast<std::size_t>(grid.size[1])) visit(index + row);
    if (k > 0) visit(index - slab);
    if (k + 1 < static_cast<std::size_t>(grid.size[2])) visit(index + slab);
}

/// Spreads `to` from the seeds over face neighbours whose value is `from`; the seeds' own value must be `from`.
/// Returns how many voxels changed. `reached`, when given, collects their indices.
std::size_t flood(Mask& mask, const VoxelGrid& grid, std::vector<std::size_t> seeds, std::uint8_t from, std::uint8_t to,
                  std::vector<std::size_t>* reached = nullptr);

/// The largest face-connected piece of the 1s (empty mask when there is none) and how many pieces there were.
struct LargestPiece {
    Mask mask;
    std::size_t voxels = 0;
    int pieces = 0;
};

/// Of all connected pieces of ones, and how many there are.
LargestPiece largest_piece(Mask mask, const VoxelGrid& grid);

}  // namespace planlight
