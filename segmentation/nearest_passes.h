#pragma once

#include <cstddef>
#include <cstdint>

namespace planlight::nearest_passes {

/// Columns of the table that are worked on at once, side by side in vector registers.
inline constexpr int kLanes = 32;

/// A stripe of kLanes columns of the table, from column `x0`, and what the two passes over it read and write.
///
/// A key is a squared distance (voxels) and, in its `bits` lowest bits, the number of the row or slice that it comes
/// from: the least key is the least distance and, among equal ones, the first.
template <class Key>
struct Stripe {
    int size_x, size_y, size_z, x0;
    unsigned bits;                   ///< at least 6
    const Key* squares;              ///< squares[d] = d * d << bits, d = -n .. n + kLanes
    const std::uint32_t* row_begin;  ///< first skin voxel of each row of the table, and one past the last
    const std::uint16_t* skin_x;     ///< column of each skin voxel; they stand in the order of the table
    const int* slices;               ///< those with skin, rising
    int slice_count;
    std::size_t row_step;    ///< lanes between two y in `keys` and `skin`
    Key* keys;               ///< [y][slice][lane]: squared distance within the slice | number of the slice
    std::uint32_t* skin;     ///< [y][slice][lane]: nearest skin voxel within the slice
    std::uint32_t* nearest;  ///< the table
};

/// Bytes of working memory that a call of either pass needs, aligned to 64.
template <class Key>
constexpr std::size_t scratch_bytes(int size_y, int size_z) {
    const auto most = static_cast<std::size_t>(size_y > size_z ? size_y : size_z) + 2;
    return most * (kLanes * (sizeof(Key) + 4) + 3 * sizeof(int)) + 256;
}

/// Both passes for one set of instructions: along x and y within slice number `slice`; along z over row `y`.
template <class Key>
struct Passes {
    void (*in_slice)(const Stripe<Key>& stripe, int slice, void* scratch);
    void (*across_slices)(const Stripe<Key>& stripe, int y, void* scratch);
};

extern const Passes<std::uint32_t> kAvx512, kAvx2, kPlain;
extern const Passes<std::uint64_t> kAvx512Wide, kAvx2Wide, kPlainWide;

}  // namespace planlight::nearest_passes
