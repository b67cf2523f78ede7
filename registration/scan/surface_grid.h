#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace planlight {

/// Points sorted into cells of the projector's picture, so that the neighbours of a point are found at once.
/// The cells are as small as lets nearly every point on a closed surface have neighbours all around.
class SurfaceGrid {
public:
    explicit SurfaceGrid(const std::vector<Eigen::Vector2i>& pixels);

    int cell_px() const { return cell_px_; }

    /// Calls `visit(other)` for every other point within `reach` cells of the point's cell.
    template <class Visit>
    void neighbours(std::size_t point, int reach, const Visit& visit) const {
        const Eigen::Vector2i c = cell_of_[point];
        for (int y = std::max(0, c.y() - reach); y <= std::min(height_ - 1, c.y() + reach); ++y)
            for (int x = std::max(0, c.x() - reach); x <= std::min(width_ - 1, c.x() + reach); ++x) {
                const std::size_t cell =
                    static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
                for (std::uint32_t k = begin_[cell]; k < begin_[cell + 1]; ++k)
                    if (sorted_[k] != point) visit(static_cast<std::size_t>(sorted_[k]));
            }
    }

private:
    void sort_into_cells(const std::vector<Eigen::Vector2i>& pixels, int cell_px);
    double occupied_around() const;

    int cell_px_ = 1, width_ = 0, height_ = 0;
    std::vector<Eigen::Vector2i> cell_of_;
    std::vector<std::uint32_t> begin_, sorted_;  ///< points of cell c: sorted_[begin_[c] .. begin_[c+1])
};

}  // namespace planlight
