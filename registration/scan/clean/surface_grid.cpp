#include "registration/scan/clean/surface_grid.h"

namespace planlight {
namespace {

/// How many of the 8 cells around an occupied cell are occupied, on average.
double occupied_around(const std::vector<Eigen::Vector2i>& pixels, const Eigen::Vector2i& low, int cell_px, int columns,
                       int rows) {
    const int width = columns + 2;  // an empty cell all around
    const auto by_cell = static_cast<float>(1.0 / cell_px);
    std::vector<std::uint8_t> occupied(static_cast<std::size_t>(width) * static_cast<std::size_t>(rows + 2), 0);
    for (const Eigen::Vector2i& p : pixels) {
        const int x = static_cast<int>((static_cast<float>(p.x() - low.x()) + 0.5f) * by_cell);
        const int y = static_cast<int>((static_cast<float>(p.y() - low.y()) + 0.5f) * by_cell);
        occupied[static_cast<std::size_t>(y + 1) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x + 1)] =
            1;
    }
    std::size_t cells = 0, around = 0;
    for (int y = 0; y < rows; ++y) {
        const std::uint8_t *above = occupied.data() + static_cast<std::ptrdiff_t>(y) * width, *line = above + width,
                           *below = line + width;
        unsigned cells_here = 0, around_here = 0;
        for (int x = 1; x <= columns; ++x) {
            const int sum = above[x - 1] + above[x] + above[x + 1] + line[x - 1] + line[x + 1] + below[x - 1] +
                            below[x] + below[x + 1];
            cells_here += line[x];
            around_here += static_cast<unsigned>(line[x] * sum);
        }
        cells += cells_here;
        around += around_here;
    }
    return cells == 0 ? 8 : static_cast<double>(around) / static_cast<double>(cells);
}

}  // namespace

SurfaceGrid::SurfaceGrid(const std::vector<Eigen::Vector2i>& pixels) {
    constexpr double kEnough = 6.5;  // of the 8 cells around an occupied one
    constexpr int kMaxCell = 32;
    if (pixels.empty()) return;
    Eigen::Vector2i low = pixels[0], high = pixels[0];
    for (const auto& p : pixels) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    for (int cell_px = 1; cell_px <= kMaxCell; cell_px += (cell_px < 4 ? 1 : cell_px / 4)) {
        cell_px_ = cell_px;
        columns_ = (high.x() - low.x()) / cell_px + 1;
        rows_ = (high.y() - low.y()) / cell_px + 1;
        if (occupied_around(pixels, low, cell_px, columns_, rows_) >= kEnough) break;
    }
    sort_into_cells(pixels, low);
}

void SurfaceGrid::sort_into_cells(const std::vector<Eigen::Vector2i>& pixels, const Eigen::Vector2i& low) {
    begin_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
    std::vector<std::uint32_t> cell_of(pixels.size());
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const Eigen::Vector2i c = (pixels[i] - low) / cell_px_;
        cell_of[i] = static_cast<std::uint32_t>(at(c.x(), c.y()));
        ++begin_[cell_of[i] + 1];
    }
    for (std::size_t c = 1; c < begin_.size(); ++c) begin_[c] += begin_[c - 1];
    order_.resize(pixels.size());
    std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
    for (std::size_t i = 0; i < pixels.size(); ++i) order_[next[cell_of[i]]++] = static_cast<std::uint32_t>(i);
}

}  // namespace planlight
