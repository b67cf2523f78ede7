#include "segmentation/fill_tunnels.h"

#include <array>
#include <bit>
#include <deque>

namespace planlight {
namespace {

constexpr int kMiddle = 13;  // of the 27 voxels of a neighbourhood, x fastest

/// How many axes two voxels of a neighbourhood differ along, when by at most one each; 4 when they are no neighbours.
constexpr int apart(int a, int b) {
    int axes = 0;
    for (int power = 1; power <= 9; power *= 3) {
        const int d = a / power % 3 - b / power % 3;
        if (d < -1 || d > 1) return 4;
        axes += d != 0;
    }
    return axes;
}

/// For each voxel of a neighbourhood those within `most` axes of it, without the middle.
constexpr std::array<std::uint32_t, 27> neighbours(int most) {
    std::array<std::uint32_t, 27> result{};
    for (int a = 0; a < 27; ++a)
        for (int b = 0; b < 27; ++b)
            if (b != kMiddle && b != a && apart(a, b) <= most) result[static_cast<std::size_t>(a)] |= 1U << b;
    return result;
}

constexpr auto kOverFaces = neighbours(1), kOverEdges = neighbours(2);

/// Whether the voxels of `set` that touch the middle are connected with each other round it.
bool connected_round_middle(std::uint32_t set, const std::array<std::uint32_t, 27>& next) {
    const std::uint32_t touching = set & next[kMiddle];
    if (touching == 0) return false;
    std::uint32_t reached = 0, fresh = touching & (~touching + 1);
    while (fresh != 0) {
        reached |= fresh;
        std::uint32_t further = 0;
        for (std::uint32_t left = fresh; left != 0; left &= left - 1)
            further |= next[static_cast<std::size_t>(std::countr_zero(left))];
        fresh = further & set & ~reached;
    }
    return (touching & ~reached) == 0;
}

/// Whether taking the middle away changes no connection, of the body (`set`) or of the air.
bool is_simple(std::uint32_t set) {
    constexpr std::uint32_t kAll = ((1U << 27) - 1) & ~(1U << kMiddle);
    return connected_round_middle(set & kAll, kOverFaces) && connected_round_middle(~set & kAll, kOverEdges);
}

}  // namespace

Mask fill_tunnels(const Mask& body, const VoxelGrid& grid) {
    constexpr std::uint8_t kAir = 0, kBody = 1, kBlock = 2, kQueued = 3;
    const Mask keep = largest_piece(body, grid).mask;
    if (keep.empty()) return keep;
    VoxelGrid wide = grid;  // with a frame of air
    for (int& n : wide.size) n += 2;
    Mask state(wide.count(), kAir);
    std::deque<std::size_t> queue;
    std::array<std::ptrdiff_t, 27> step{};
    for (std::ptrdiff_t n = 0; n < 27; ++n)
        step[static_cast<std::size_t>(n)] = n % 3 - 1 + (n / 3 % 3 - 1) * static_cast<std::ptrdiff_t>(wide.row()) +
                                            (n / 9 - 1) * static_cast<std::ptrdiff_t>(wide.slab());
    const auto for_all = [&](auto&& visit) {
        std::size_t at = 0;
        for (int k = 1; k <= grid.size[2]; ++k)
            for (int j = 1; j <= grid.size[1]; ++j) {
                std::size_t v =
                    static_cast<std::size_t>(k) * wide.slab() + static_cast<std::size_t>(j) * wide.row() + 1;
                for (int i = 0; i < grid.size[0]; ++i) visit(at++, v++);
            }
    };
    for_all([&](std::size_t at, std::size_t v) { state[v] = keep[at] ? kBody : kBlock; });
    const auto ask_again_round = [&](std::size_t v) {
        for (const std::ptrdiff_t s : step) {
            const std::size_t n = v + static_cast<std::size_t>(s);
            if (state[n] != kBlock) continue;
            state[n] = kQueued;
            queue.push_back(n);
        }
    };
    for_all([&](std::size_t, std::size_t v) {
        for (const int face : {4, 10, 12, 14, 16, 22})
            if (state[v] == kBlock &&
                state[v + static_cast<std::size_t>(step[static_cast<std::size_t>(face)])] == kAir) {
                state[v] = kQueued;
                queue.push_back(v);
            }
    });
    while (!queue.empty()) {
        const std::size_t v = queue.front();
        queue.pop_front();
        std::uint32_t set = 0;
        for (std::size_t n = 0; n < 27; ++n)
            set |= static_cast<std::uint32_t>(state[v + static_cast<std::size_t>(step[n])] != kAir) << n;
        state[v] = is_simple(set) ? kAir : kBlock;
        if (state[v] == kAir) ask_again_round(v);
    }
    Mask filled(body.size());
    for_all([&](std::size_t at, std::size_t v) { filled[at] = state[v] != kAir; });
    return filled;
}

}  // namespace planlight
