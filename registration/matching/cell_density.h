#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace planlight {

/// So many points of a cell say at most how dense a scan is: a heap of them at one place, as what was not measured is
/// at the origin, says nothing of it. `points`: the member that counts a cell's.
template <class Cell>
int most_to_count(const std::vector<Cell>& cells, int Cell::*points) {
    constexpr std::size_t kTimesMean = 8;
    std::size_t all = 0;
    for (const Cell& cell : cells) all += static_cast<std::size_t>(cell.*points);
    return static_cast<int>(1 + kTimesMean * all / std::max<std::size_t>(1, cells.size()));
}

}  // namespace planlight
