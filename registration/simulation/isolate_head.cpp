#include "registration/simulation/isolate_head.h"

#include <algorithm>
#include <cmath>

namespace planlight::simulation {

namespace {

using Mask = std::vector<std::uint8_t>;

/// One axis of a cube dilation of the voxels that equal `value`: what is within `reach` of one becomes one.
void spread_along(Mask& mask, const std::array<int, 3>& size, int axis, int reach, std::uint8_t value) {
    const std::array<std::size_t, 3> stride{1, static_cast<std::size_t>(size[0]),
                                            static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1])};
    const int a = (axis + 1) % 3, b = (axis + 2) % 3, n = size[static_cast<std::size_t>(axis)];
    const std::size_t step = stride[static_cast<std::size_t>(axis)];
    Mask before;
    for (int q = 0; q < size[static_cast<std::size_t>(b)]; ++q)
        for (int p = 0; p < size[static_cast<std::size_t>(a)]; ++p) {
            std::uint8_t* line = mask.data() + static_cast<std::size_t>(p) * stride[static_cast<std::size_t>(a)] +
                                 static_cast<std::size_t>(q) * stride[static_cast<std::size_t>(b)];
            before.resize(static_cast<std::size_t>(n));
            for (int i = 0; i < n; ++i) before[static_cast<std::size_t>(i)] = line[static_cast<std::size_t>(i) * step];
            int last = -1 - reach;
            for (int i = 0; i < n; ++i) {
                if (before[static_cast<std::size_t>(i)] == value) last = i;
                if (i - last <= reach) line[static_cast<std::size_t>(i) * step] = value;
            }
            last = n + reach;
            for (int i = n - 1; i >= 0; --i) {
                if (before[static_cast<std::size_t>(i)] == value) last = i;
                if (last - i <= reach) line[static_cast<std::size_t>(i) * step] = value;
            }
        }
}

/// Calls `visit` with every 6-neighbour of a voxel.
template <typename Visit>
void for_neighbours(std::size_t at, const std::array<int, 3>& size, Visit&& visit) {
    const std::size_t row = static_cast<std::size_t>(size[0]), slice = row * static_cast<std::size_t>(size[1]);
    const auto i = static_cast<int>(at % row), j = static_cast<int>(at / row % static_cast<std::size_t>(size[1])),
               k = static_cast<int>(at / slice);
    if (i > 0) visit(at - 1);
    if (i + 1 < size[0]) visit(at + 1);
    if (j > 0) visit(at - row);
    if (j + 1 < size[1]) visit(at + row);
    if (k > 0) visit(at - slice);
    if (k + 1 < size[2]) visit(at + slice);
}

/// The largest 6-connected body of `mask`.
Mask largest_body(const Mask& mask, const std::array<int, 3>& size) {
    Mask left = mask;
    std::vector<std::size_t> body, best;
    for (std::size_t seed = 0; seed < left.size(); ++seed) {
        if (!left[seed]) continue;
        body.assign(1, seed);
        left[seed] = 0;
        for (std::size_t next = 0; next < body.size(); ++next)
            for_neighbours(body[next], size, [&](std::size_t n) {
                if (left[n]) {
                    left[n] = 0;
                    body.push_back(n);
                }
            });
        if (body.size() > best.size()) best.swap(body);
    }
    Mask result(mask.size(), 0);
    for (const std::size_t v : best) result[v] = 1;
    return result;
}

std::array<int, 3> voxels_of(double mm, const Volume& volume) {
    const Eigen::Vector3d spacing = volume.spacing_mm();
    std::array<int, 3> n{};
    for (int a = 0; a < 3; ++a)
        n[static_cast<std::size_t>(a)] = std::max(1, static_cast<int>(std::lround(mm / spacing[a])));
    return n;
}

}  // namespace

Mask grown(const Mask& mask, const std::array<int, 3>& size, const std::array<int, 3>& reach) {
    Mask result = mask;
    for (int axis = 0; axis < 3; ++axis) spread_along(result, size, axis, reach[static_cast<std::size_t>(axis)], 1);
    return result;
}

Mask head_voxels(const Volume& volume, double threshold) {
    constexpr double kWornAway_mm = 2, kGrownBack_mm = 30, kLeastHead_mm3 = 50e3;
    Mask above(volume.values.size());
    std::transform(volume.values.begin(), volume.values.end(), above.begin(),
                   [&](float v) { return static_cast<std::uint8_t>(v > threshold); });
    Mask head = above;
    const auto worn = voxels_of(kWornAway_mm, volume);
    for (int axis = 0; axis < 3; ++axis) spread_along(head, volume.size, axis, worn[static_cast<std::size_t>(axis)], 0);
    head = largest_body(head, volume.size);
    const double voxel_mm3 = std::abs(volume.ct_from_voxel.linear().determinant());
    if (static_cast<double>(std::count(head.begin(), head.end(), 1)) * voxel_mm3 < kLeastHead_mm3) return {};
    // Thin parts that hang on the head (ears, nose) come back; what only touches through air does not.
    std::vector<std::size_t> front, next;
    for (std::size_t v = 0; v < head.size(); ++v)
        if (head[v]) front.push_back(v);
    const int steps = static_cast<int>(kGrownBack_mm / volume.spacing_mm().minCoeff());
    for (int step = 0; step < steps && !front.empty(); ++step) {
        next.clear();
        for (const std::size_t v : front)
            for_neighbours(v, volume.size, [&](std::size_t n) {
                if (!above[n] || head[n]) return;
                head[n] = 1;
                next.push_back(n);
            });
        front.swap(next);
    }
    return head;
}

}  // namespace planlight::simulation
