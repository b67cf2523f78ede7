#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace planlight {

/// The value of rank `share` (0 to 1, rounded down) among `values`; 0 when there are none. Move what is not needed
/// afterwards: the order changes.
template <class T>
T quantile(std::vector<T> values, double share) {
    if (values.empty()) return T{};
    const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
    const auto at = values.begin() + std::min(rank, static_cast<std::ptrdiff_t>(values.size()) - 1);
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

/// The middle one of `values`; of an even number the upper one of both in the middle. 0 when there are none.
template <class T>
T median(std::vector<T> values) {
    return quantile(std::move(values), 0.5);
}

}  // namespace planlight
