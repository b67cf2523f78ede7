#include "app/windows/orientation.h"

#include <algorithm>
#include <cmath>

namespace planlight {

ViewAxes axes_of(const SceneView& view) {
    const double az = view.azimuth, el = view.elevation;
    ViewAxes axes;
    axes.backward_in_ct = {-std::sin(az) * std::cos(el), -std::cos(az) * std::cos(el), std::sin(el)};
    const Eigen::Vector3d level(std::cos(az), -std::sin(az), 0), upright = axes.backward_in_ct.cross(level);
    axes.right_in_ct = std::cos(view.roll) * level + std::sin(view.roll) * upright;
    axes.up_in_ct = axes.backward_in_ct.cross(axes.right_in_ct);
    return axes;
}

SceneView view_along(const Eigen::Vector3d& backward_in_ct, const Eigen::Vector3d& up_in_ct) {
    const Eigen::Vector3d backward = backward_in_ct.normalized();
    const Eigen::Vector3d up = (up_in_ct - up_in_ct.dot(backward) * backward).normalized();
    SceneView view{0, std::asin(std::clamp(backward.z(), -1.0, 1.0)), 0, 1, Eigen::Vector2d::Zero()};
    if (std::hypot(backward.x(), backward.y()) > 1e-9) view.azimuth = std::atan2(-backward.x(), -backward.y());
    const ViewAxes level = axes_of(view);
    view.roll = std::atan2(-up.dot(level.right_in_ct), up.dot(level.up_in_ct));
    return view;
}

SceneView standard_view(char side) {
    switch (side) {
        case 'P':
            return {M_PI, 0, 0, 1, Eigen::Vector2d::Zero()};
        case 'L':
            return {-M_PI / 2, 0, 0, 1, Eigen::Vector2d::Zero()};
        case 'R':
            return {M_PI / 2, 0, 0, 1, Eigen::Vector2d::Zero()};
        case 'S':
            return {0, M_PI / 2, 0, 1, Eigen::Vector2d::Zero()};
        default:
            return {0, 0, 0, 1, Eigen::Vector2d::Zero()};
    }
}

SceneView surgeon_view(const Eigen::Vector3d& away_in_ct) {
    const Eigen::Vector3d above(0, -1, 0);  // the patient lies on the back
    return view_along(above - 0.7 * away_in_ct.normalized(), away_in_ct);
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
