#include "segmentation/outside_air.h"

namespace planlight {
namespace {

std::size_t offset(const VoxelGrid& grid, int i, int j, int k) {
    return static_cast<std::size_t>(k) * grid.slab() + static_cast<std::size_t>(j) * grid.row() +
           static_cast<std::size_t>(i);
}

/// Free voxels of one face of the array (axis fixed at its first or last index) that reach the face's rim inside the
/// face.
void add_face_seeds(const Mask& solid, const VoxelGrid& grid, int axis, bool last, std::vector<std::size_t>& seeds) {
    const int a = axis == 0 ? 1 : 0, b = axis == 2 ? 1 : 2;
    const int na = grid.size[static_cast<std::size_t>(a)], nb = grid.size[static_cast<std::size_t>(b)];
    const auto volume_index = [&](std::size_t in_face) {
        int at[3];
        at[axis] = last ? grid.size[static_cast<std::size_t>(axis)] - 1 : 0;
        at[a] = static_cast<int>(in_face % static_cast<std::size_t>(na));
        at[b] = static_cast<int>(in_face / static_cast<std::size_t>(na));
        return offset(grid, at[0], at[1], at[2]);
    };
    const VoxelGrid face_grid{{na, nb, 1}, {1, 1, 1}};
    Mask face(face_grid.count());
    std::vector<std::size_t> rim;
    for (std::size_t f = 0; f < face.size(); ++f) {
        face[f] = solid[volume_index(f)];
        const int x = static_cast<int>(f % static_cast<std::size_t>(na)),
                  y = static_cast<int>(f / static_cast<std::size_t>(na));
        if (x == 0 || y == 0 || x == na - 1 || y == nb - 1) rim.push_back(f);
    }
    std::vector<std::size_t> reached;
    flood(face, face_grid, rim, 0, 2, &reached);
    for (const std::size_t f : reached) seeds.push_back(volume_index(f));
}

/// Spreads `outside` (1) through the free voxels of `near`.
void spread(Mask& outside, const Mask& body, const Mask& near, const VoxelGrid& grid) {
    std::vector<std::size_t> seeds;
    for (std::size_t i = 0; i < outside.size(); ++i) {
        if (outside[i]) seeds.push_back(i);
        outside[i] = outside[i] || (!body[i] && near[i]) ? 3 : 0;
    }
    flood(outside, grid, std::move(seeds), 3, 1);
    for (auto& v : outside) v = v == 1;
}

/// Gives pockets to the outside that touch it and lie wholly within `reach_mm` of it.
void take_back_pockets(Mask& outside, const Mask& body, const VoxelGrid& grid, double reach_mm) {
    constexpr std::uint8_t kPocket = 2, kSeen = 3;
    const Mask near = dilate(outside, grid, reach_mm);
    Mask state(outside.size());
    for (std::size_t i = 0; i < state.size(); ++i) state[i] = outside[i] ? 1 : body[i] ? 0 : kPocket;
    for (std::size_t i = 0; i < state.size(); ++i) {
        if (state[i] != kPocket) continue;
        std::vector<std::size_t> pocket;
        flood(state, grid, {i}, kPocket, kSeen, &pocket);
        bool open = false, shallow = true;
        for (const std::size_t v : pocket) {
            shallow = shallow && near[v];
            for_face_neighbours(grid, v, [&](std::size_t n) { open = open || state[n] == 1; });
        }
        if (open && shallow)
            for (const std::size_t v : pocket) outside[v] = 1;
    }
}

}  // namespace

Mask outside_air(const Mask& solid, const VoxelGrid& grid) {
    std::vector<std::size_t> seeds;
    for (int axis = 0; axis < 3; ++axis)
        for (const bool last : {false, true}) add_face_seeds(solid, grid, axis, last, seeds);
    Mask air = solid;
    flood(air, grid, std::move(seeds), 0, 2);
    for (auto& v : air) v = v == 2;
    return air;
}

Mask outside_air_sealed(const Mask& body, const VoxelGrid& grid, double seal_radius_mm) {
    Mask outside = outside_air(close(body, grid, seal_radius_mm), grid);
    spread(outside, body, dilate(outside, grid, seal_radius_mm / 2), grid);
    take_back_pockets(outside, body, grid, seal_radius_mm);
    return outside;
}

}  // namespace planlight
