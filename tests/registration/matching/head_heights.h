#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "tests/registration/matching/trial_surface.h"

namespace planlight::test {

/// A view of the head: origin on the skin in the middle of the picture, x right, y down, z to the devices.
struct ViewFrame {
    Eigen::Isometry3d ct_from_view = Eigen::Isometry3d::Identity();
    Eigen::Vector3d to_ct(const Eigen::Vector3d& p) const { return ct_from_view * p; }
};

/// How high the head stands over the view's plane, on a grid of 3 mm; `kNothing_mm` beside it.
class HeadHeights {
public:
    static constexpr double kNothing_mm = -250;

    HeadHeights(const TrialSurface& head, const ViewFrame& view);
    /// A tight skin over the head and a floor: closed by discs of the radius, then smoothed; nowhere under the head.
    HeadHeights covered(double floor_mm, double radius_mm) const;
    /// Interpolated; at the rim the rim's.
    double operator()(double x_mm, double y_mm) const;

private:
    static constexpr double kCell_mm = 3, kWidth_mm = 480;
    static constexpr int kSide = 161;
    double& at(int i, int j) { return z_[static_cast<std::size_t>(j * kSide + i)]; }
    double at(int i, int j) const { return z_[static_cast<std::size_t>(j * kSide + i)]; }
    /// The highest (lowest) within a disc, everywhere.
    void take(double radius_mm, bool highest);
    void smooth();
    std::vector<double> z_;
};

}  // namespace planlight::test
