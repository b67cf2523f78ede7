#include "registration/scan/surface_grid.h"

namespace planlight {

SurfaceGrid::SurfaceGrid(const std::vector<Eigen::Vector2i>& pixels) {
    constexpr double kEnough = 6.5;  // of the 8 cells around an occupied one
    constexpr int kMaxCell = 32;
    for (int cell_px = 1; cell_px <= kMaxCell; cell_px += (cell_px < 4 ? 1 : cell_px / 4)) {
        sort_into_cells(pixels, cell_px);
        if (occupied_around() >= kEnough) return;
    }
}

void SurfaceGrid::sort_into_cells(const std::vector<Eigen::Vector2i>& pixels, int cell_px) {
    cell_px_ = cell_px;
    cell_of_.resize(pixels.size());
    if (pixels.empty()) return;
    Eigen::Vector2i low = pixels[0], high = pixels[0];
    for (const auto& p : pixels) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    width_ = (high.x() - low.x()) / cell_px + 1;
    height_ = (high.y() - low.y()) / cell_px + 1;
    begin_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_) + 1, 0);
    const auto index = [&](const Eigen::Vector2i& c) {
        return static_cast<std::size_t>(c.y()) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(c.x());
    };
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        cell_of_[i] = (pixels[i] - low) / cell_px;
        ++begin_[index(cell_of_[i]) + 1];
    }
    for (std::size_t c = 1; c < begin_.size(); ++c) begin_[c] += begin_[c - 1];
    sorted_.resize(pixels.size());
    std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
    for (std::size_t i = 0; i < pixels.size(); ++i) sorted_[next[index(cell_of_[i])]++] = static_cast<std::uint32_t>(i);
}

/// How many of the 8 cells around an occupied cell are occupied, on average.
double SurfaceGrid::occupied_around() const {
    const auto occupied = [&](int x, int y) {
        if (x < 0 || y < 0 || x >= width_ || y >= height_) return 0;
        const std::size_t c = static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
        return begin_[c + 1] > begin_[c] ? 1 : 0;
    };
    std::size_t cells = 0, around = 0;
    for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x) {
            if (!occupied(x, y)) continue;
            ++cells;
            for (int dy = -1; dy <= 1; ++dy)
                for (int dx = -1; dx <= 1; ++dx)
                    if (dx != 0 || dy != 0) around += static_cast<std::size_t>(occupied(x + dx, y + dy));
        }
    return cells == 0 ? 8 : static_cast<double>(around) / static_cast<double>(cells);
}

}  // namespace planlight
