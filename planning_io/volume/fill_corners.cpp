#include "planning_io/volume/fill_corners.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace planlight {
namespace {

constexpr float kAir_hu = -1000;
constexpr double kLeastCornerShare = 0.005;  // of a slice

}  // namespace

std::vector<char> joined_to_edge(int columns, int rows, const std::function<bool(std::size_t)>& wanted) {
    std::vector<char> marks(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), 0);
    std::vector<std::pair<int, int>> open;
    const auto visit = [&](int i, int j) {
        if (i < 0 || j < 0 || i >= columns || j >= rows) return;
        const std::size_t at =
            static_cast<std::size_t>(j) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(i);
        if (marks[at] || !wanted(at)) return;
        marks[at] = 1;
        open.emplace_back(i, j);
    };
    for (int i = 0; i < columns; ++i) visit(i, 0), visit(i, rows - 1);
    for (int j = 0; j < rows; ++j) visit(0, j), visit(columns - 1, j);
    while (!open.empty()) {
        const auto [i, j] = open.back();
        open.pop_back();
        visit(i - 1, j), visit(i + 1, j), visit(i, j - 1), visit(i, j + 1);
    }
    return marks;
}

void fill_corners(Volume& volume) {
    if (!volume.is_hu) return;
    const std::size_t slab = volume.index(0, 0, 1);
    std::size_t filled = 0;
    for (int k = 0; k < volume.size[2]; ++k) {
        float* values = volume.values.data() + static_cast<std::size_t>(k) * slab;
        const auto marks =
            joined_to_edge(volume.size[0], volume.size[1], [&](std::size_t at) { return values[at] == 0; });
        const auto count = static_cast<std::size_t>(std::count(marks.begin(), marks.end(), 1));
        if (static_cast<double>(count) < kLeastCornerShare * static_cast<double>(slab)) continue;
        for (std::size_t at = 0; at < slab; ++at)
            if (marks[at]) values[at] = kAir_hu;
        filled += count;
    }
    if (filled > 0)
        volume.notes.push_back(
            fmt::format("{} voxels of exactly 0 HU at the pictures' edges were made air: fill, not water", filled));
}

}  // namespace planlight
