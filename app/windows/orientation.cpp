#include "app/windows/orientation.h"

#include <algorithm>
#include <cmath>

namespace planlight {

ViewAxes axes_of(const SceneView& view) {
    const double az = view.azimuth, el = view.elevation;
    ViewAxes axes;
    axes.backward_in_ct = {-std::sin(az) * std::cos(el), -std::cos(az) * std::cos(el), std::sin(el)};
    axes.right_in_ct = {std::cos(az), -std::sin(az), 0};
    axes.up_in_ct = axes.backward_in_ct.cross(axes.right_in_ct);
    return axes;
}

std::string direction_letters(const Eigen::Vector3d& direction_in_ct) {
    constexpr char kNegative[] = {'R', 'A', 'I'};
    constexpr char kPositive[] = {'L', 'P', 'S'};
    std::array<int, 3> order{0, 1, 2};
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return std::abs(direction_in_ct[a]) > std::abs(direction_in_ct[b]); });
    std::string letters;
    for (const int axis : order) {
        const double part = direction_in_ct[axis] / direction_in_ct.norm();
        if (letters.size() < 2 && (letters.empty() || std::abs(part) >= 0.5))
            letters += part < 0 ? kNegative[axis] : kPositive[axis];
    }
    return letters;
}

}  // namespace planlight
