#include "planning_io/plan/contour_stack.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>

namespace planlight {

using Eigen::Vector3d;

std::size_t heights_of_contours(const std::vector<std::vector<Vector3d>>& closed_contours) {
    constexpr double kOneHeight_mm = 0.1;
    std::vector<double> heights;
    std::optional<Vector3d> normal;
    for (const auto& p : closed_contours) {
        Vector3d area = Vector3d::Zero(), centre = Vector3d::Zero();
        for (std::size_t i = 0; i < p.size(); ++i) {
            area += (p[i] - p[0]).cross(p[(i + 1) % p.size()] - p[0]);
            centre += p[i] / static_cast<double>(p.size());
        }
        if (!normal && area.norm() > 1e-6) normal = area.normalized();
        if (normal) heights.push_back(normal->dot(centre));
    }
    std::sort(heights.begin(), heights.end());
    std::size_t count = heights.empty() ? 0 : 1;
    for (std::size_t i = 1; i < heights.size(); ++i) count += heights[i] - heights[i - 1] > kOneHeight_mm;
    return count;
}

}  // namespace planlight
