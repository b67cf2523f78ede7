#include "segmentation/voxel_morphology.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace planlight {
namespace {

// Squared distances above the radius are only "far": the passes look no further than the radius, so they cost
// O(radius).
constexpr float kFar = 1e9F;

void distance_along_row(const std::uint8_t* mask, std::uint8_t target, float* squared, int n, double spacing_mm) {
    int last = -n - 1;
    const auto step = static_cast<float>(spacing_mm);
    for (int i = 0; i < n; ++i) {
        if (mask[i] == target) last = i;
        const float d = step * static_cast<float>(i - last);
        squared[i] = last < 0 ? kFar : d * d;
    }
    last = 2 * n + 1;
    for (int i = n - 1; i >= 0; --i) {
        if (mask[i] == target) last = i;
        const float d = step * static_cast<float>(last - i);
        if (last < n) squared[i] = std::min(squared[i], d * d);
    }
}

/// out = min over offsets o of in[o lines away] + (o spacing)^2, for one line of `length` values.
void min_over_offsets(const float* in, float* out, std::size_t length, std::size_t stride, int at, int n,
                      double spacing_mm, double radius_mm) {
    std::copy_n(in, length, out);
    const int reach = static_cast<int>(std::floor(radius_mm / spacing_mm));
    for (int o = -reach; o <= reach; ++o) {
        if (o == 0 || at + o < 0 || at + o >= n) continue;
        const float* other =
            o < 0 ? in - static_cast<std::size_t>(-o) * stride : in + static_cast<std::size_t>(o) * stride;
        const auto add = static_cast<float>((o * spacing_mm) * (o * spacing_mm));
        for (std::size_t i = 0; i < length; ++i) out[i] = std::min(out[i], other[i] + add);
    }
}

}  // namespace

VoxelGrid grid_of(const Volume& volume) {
    return {volume.size, volume.spacing_mm()};
}

Mask within(const Mask& mask, std::uint8_t target, const VoxelGrid& grid, double radius_mm) {
    std::vector<float> a(grid.count()), b(grid.count());
    const std::size_t row = grid.row(), slab = grid.slab();
    const int nj = grid.size[1], nk = grid.size[2];
    tbb::parallel_for(0, nk, [&](int k) {
        for (int j = 0; j < nj; ++j) {
            const std::size_t at = static_cast<std::size_t>(k) * slab + static_cast<std::size_t>(j) * row;
            distance_along_row(mask.data() + at, target, a.data() + at, grid.size[0], grid.spacing_mm.x());
        }
        for (int j = 0; j < nj; ++j) {
            const std::size_t at = static_cast<std::size_t>(k) * slab + static_cast<std::size_t>(j) * row;
            min_over_offsets(a.data() + at, b.data() + at, row, row, j, nj, grid.spacing_mm.y(), radius_mm);
        }
    });
    Mask result(grid.count());
    const auto limit = static_cast<float>(radius_mm * radius_mm * (1 + 1e-6));
    tbb::parallel_for(0, nk, [&](int k) {
        const std::size_t at = static_cast<std::size_t>(k) * slab;
        min_over_offsets(b.data() + at, a.data() + at, slab, slab, k, nk, grid.spacing_mm.z(), radius_mm);
        for (std::size_t i = at; i < at + slab; ++i) result[i] = a[i] <= limit;
    });
    return result;
}

Mask erode(const Mask& mask, const VoxelGrid& grid, double radius_mm) {
    Mask result = within(mask, 0, grid, radius_mm);
    for (auto& v : result) v = !v;
    return result;
}

Mask dilate(const Mask& mask, const VoxelGrid& grid, double radius_mm) {
    return within(mask, 1, grid, radius_mm);
}

Mask close(const Mask& mask, const VoxelGrid& grid, double radius_mm) {
    VoxelGrid padded = grid;
    std::array<std::size_t, 3> pad{};
    for (std::size_t a = 0; a < 3; ++a) {
        pad[a] = static_cast<std::size_t>(std::ceil(radius_mm / grid.spacing_mm[static_cast<int>(a)])) + 1;
        padded.size[a] += 2 * static_cast<int>(pad[a]);
    }
    const auto for_rows = [&](auto&& visit) {
        for (int k = 0; k < grid.size[2]; ++k)
            for (int j = 0; j < grid.size[1]; ++j)
                visit(static_cast<std::size_t>(k) * grid.slab() + static_cast<std::size_t>(j) * grid.row(),
                      (static_cast<std::size_t>(k) + pad[2]) * padded.slab() +
                          (static_cast<std::size_t>(j) + pad[1]) * padded.row() + pad[0]);
    };
    Mask space(padded.count(), 0);
    for_rows([&](std::size_t in, std::size_t out) { std::copy_n(mask.data() + in, grid.row(), space.data() + out); });
    space = erode(dilate(space, padded, radius_mm), padded, radius_mm);
    Mask result(mask.size());
    for_rows([&](std::size_t in, std::size_t out) { std::copy_n(space.data() + out, grid.row(), result.data() + in); });
    return result;
}

std::size_t flood(Mask& mask, const VoxelGrid& grid, std::vector<std::size_t> seeds, std::uint8_t from, std::uint8_t to,
                  std::vector<std::size_t>* reached) {
    // Runs of a row at a time, with one seed for each run beside them: no voxel is divided into its place but a seed.
    const std::size_t row = grid.row(), slab = grid.slab();
    const auto nj = static_cast<std::size_t>(grid.size[1]), nk = static_cast<std::size_t>(grid.size[2]);
    std::size_t changed = 0;
    const auto seed_runs = [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v)
            if (mask[v] == from && (v + 1 == end || mask[v + 1] != from)) seeds.push_back(v);
    };
    while (!seeds.empty()) {
        const std::size_t seed = seeds.back();
        seeds.pop_back();
        if (mask[seed] != from) continue;
        const std::size_t line = seed / row, first = line * row, last = first + row;
        std::size_t begin = seed, end = seed + 1;
        while (begin > first && mask[begin - 1] == from) --begin;
        while (end < last && mask[end] == from) ++end;
        for (std::size_t v = begin; v < end; ++v) {
            mask[v] = to;
            if (reached != nullptr) reached->push_back(v);
        }
        changed += end - begin;
        const std::size_t j = line % nj, k = line / nj;
        if (j > 0) seed_runs(begin - row, end - row);
        if (j + 1 < nj) seed_runs(begin + row, end + row);
        if (k > 0) seed_runs(begin - slab, end - slab);
        if (k + 1 < nk) seed_runs(begin + slab, end + slab);
    }
    return changed;
}

LargestPiece largest_piece(Mask mask, const VoxelGrid& grid) {
    LargestPiece best;
    std::size_t best_seed = 0;
    for (std::size_t index = 0; index < mask.size(); ++index) {
        if (mask[index] != 1) continue;
        const std::size_t voxels = flood(mask, grid, {index}, 1, 2);
        ++best.pieces;
        if (voxels > best.voxels) {
            best.voxels = voxels;
            best_seed = index;
        }
    }
    if (best.voxels > 0) flood(mask, grid, {best_seed}, 2, 1);
    for (auto& v : mask) v = v == 1;
    best.mask = std::move(mask);
    return best;
}

}  // namespace planlight
