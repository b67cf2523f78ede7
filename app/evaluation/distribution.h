#pragma once

#include <cstddef>
#include <vector>

namespace planlight {

/// A sample by its median, 95th percentile and worst. All zero when the sample is empty (see `count`).
struct Distribution {
    std::size_t count = 0;
    double median = 0, p95 = 0, worst = 0;
};

/// Of values as they are (take absolute values first). NaN counts as worst: it sorts last.
Distribution distribution_of(std::vector<double> values);

}  // namespace planlight
