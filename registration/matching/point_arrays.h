#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace planlight {

/// Points as three plain arrays, relative to `centre`, for the inner loops: float is exact to 1e-5 mm there.
struct PointArrays {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    std::vector<float> x, y, z;

    PointArrays() = default;
    PointArrays(std::span<const Eigen::Vector3d> points, const Eigen::Vector3d& around) : centre(around) {
        x.reserve(points.size());
        y.reserve(points.size());
        z.reserve(points.size());
        for (const Eigen::Vector3d& p : points) {
            x.push_back(static_cast<float>(p.x() - around.x()));
            y.push_back(static_cast<float>(p.y() - around.y()));
            z.push_back(static_cast<float>(p.z() - around.z()));
        }
    }
    std::size_t size() const { return x.size(); }
};

}  // namespace planlight
