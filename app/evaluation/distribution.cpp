#include "app/evaluation/distribution.h"

#include <algorithm>
#include <cmath>

namespace planlight {

Distribution distribution_of(std::vector<double> values) {
    if (values.empty()) return {};
    std::sort(values.begin(), values.end(), [](double a, double b) { return std::isnan(b) ? !std::isnan(a) : a < b; });
    const auto at = [&](double share) {
        const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
        return values[std::max<std::size_t>(rank, 1) - 1];
    };
    return {values.size(), at(0.5), at(0.95), values.back()};
}

}  // namespace planlight
