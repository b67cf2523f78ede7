#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace planlight {

/// Which cubes of side 1 with their centres at whole numbers a triangle passes through: separating axes (Akenine-Moller
/// 2001), all that does not depend on the cube worked out once.
class TriangleInVoxels {
public:
    /// The triangle in voxels.
    explicit TriangleInVoxels(const std::array<Eigen::Vector3d, 3>& t)
        : low(floor_of(t[0].cwiseMin(t[1]).cwiseMin(t[2]))), high(floor_of(t[0].cwiseMax(t[1]).cwiseMax(t[2]))) {
        std::array<Eigen::Vector3d, 3> near;  // small numbers lose no digits
        for (std::size_t c = 0; c < 3; ++c) near[c] = t[c] - low.cast<double>();
        const std::array<Eigen::Vector3d, 3> edges{near[1] - near[0], near[2] - near[1], near[0] - near[2]};
        add_axis(edges[0].cross(edges[1]), near);
        for (const auto& e : edges) {
            add_axis({0, -e.z(), e.y()}, near);
            add_axis({e.z(), 0, -e.x()}, near);
            add_axis({-e.y(), e.x(), 0}, near);
        }
    }

    const Eigen::Vector3i low, high;  ///< the only voxels to ask for

    bool passes(const Eigen::Vector3i& voxel) const {
        const Eigen::Vector3d centre = (voxel - low).cast<double>();
        for (const Axis& axis : axes_) {
            const double at = axis.way.dot(centre);
            if (at < axis.least || at > axis.most) return false;
        }
        return true;
    }

private:
    static constexpr double kHalf = 0.5 + 1e-9;  // a triangle that only touches a cube passes through it

    struct Axis {
        Eigen::Vector3d way;
        double least, most;  ///< where a cube's centre must be along it
    };

    static Eigen::Vector3i floor_of(const Eigen::Vector3d& p) { return (p.array() + 0.5).floor().cast<int>(); }

    void add_axis(const Eigen::Vector3d& way, const std::array<Eigen::Vector3d, 3>& t) {
        const double a = way.dot(t[0]), b = way.dot(t[1]), c = way.dot(t[2]), reach = kHalf * way.cwiseAbs().sum();
        axes_[count_++] = {way, std::min({a, b, c}) - reach, std::max({a, b, c}) + reach};
    }

    std::array<Axis, 10> axes_;
    std::size_t count_ = 0;
};

}  // namespace planlight
