#include "tests/registration/projector_measurement/measured_rooms.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace planlight::test {

void print(const std::string& what, std::vector<double> values, const std::string& unit) {
    if (values.empty()) return fmt::print("{:<58} none\n", what);
    std::sort(values.begin(), values.end());
    const auto at = [&](double share) {
        const auto n = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
        return values[std::max<std::size_t>(n, 1) - 1];
    };
    fmt::print("{:<58} {:4}: {:8.4f} / {:8.4f} / {:8.4f} {}\n", what, values.size(), at(0.5), at(0.95), values.back(),
               unit);
    std::fflush(stdout);
}

}  // namespace planlight::test
