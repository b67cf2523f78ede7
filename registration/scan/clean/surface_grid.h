#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace planlight {

/// Points sorted into cells of the projector's picture, so that the neighbours of a point are found at once: those of a
/// run of cells of one line follow each other. The cells are as small as lets nearly every point on a closed surface
/// have neighbours all around.
class SurfaceGrid {
public:
    explicit SurfaceGrid(const std::vector<Eigen::Vector2i>& pixels);

    int cell_px() const { return cell_px_; }
    int columns() const { return columns_; }
    int rows() const { return rows_; }

    /// Indices of the points, cell by cell, line by line. Places in this list are what `in_cells` speaks of.
    const std::vector<std::uint32_t>& order() const { return order_; }

    /// Places of the points in the cells [column - reach, column + reach] of a line; empty outside the grid.
    std::pair<std::uint32_t, std::uint32_t> in_cells(int row, int column, int reach) const {
        if (row < 0 || row >= rows_) return {0, 0};
        const int first = column < reach ? 0 : column - reach,
                  end = column + reach >= columns_ ? columns_ : column + reach + 1;
        return {begin_[at(first, row)], begin_[at(end, row)]};
    }

private:
    void sort_into_cells(const std::vector<Eigen::Vector2i>& pixels, const Eigen::Vector2i& low);
    std::size_t at(int column, int row) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
    }

    int cell_px_ = 1, columns_ = 0, rows_ = 0;
    std::vector<std::uint32_t> begin_, order_;  ///< points of cell c: order_[begin_[c] .. begin_[c+1])
};

}  // namespace planlight
