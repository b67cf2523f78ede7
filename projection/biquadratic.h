#pragma once

#include <array>
#include <cstddef>

namespace planlight {

/// What the quadratic through nine values gives at (u, v): those at (-1, -1), (0, -1), (1, -1), (-1, 0), ... (1, 1).
template <class Value>
Value biquadratic(const std::array<Value, 9>& at, double u, double v) {
    const auto weights = [](double t) { return std::array{t * (t - 1) / 2, 1 - t * t, t * (t + 1) / 2}; };
    const std::array<double, 3> a = weights(u), b = weights(v);
    Value sum = Value::Zero();
    for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t column = 0; column < 3; ++column) sum += b[row] * a[column] * at[3 * row + column];
    return sum;
}

}  // namespace planlight
