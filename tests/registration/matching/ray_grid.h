#pragma once

#include <Eigen/Core>
#include <random>
#include <vector>

namespace planlight::test {

/// The rays of a simulated scan, row by row, and what each met; in ct, mm.
struct RayGrid {
    int columns = 0, rows = 0;
    double spacing_mm = 0;                      ///< between neighbouring rays, at the head
    std::vector<Eigen::Vector3d> direction, p;  ///< `p` where it met something, else zero
    std::vector<char> met;

    std::vector<std::size_t> those_that_met() const;
    /// The plane through 7 x 7 rays that met about the same surface, as a scan estimates it; towards the devices.
    Eigen::Vector3d normal_at(std::size_t ray) const;
};

/// What a scan adds to the depth of a point: noise, and now and then it is a stray, 15 to 100 mm off, either way.
class DepthSpoiler {
public:
    DepthSpoiler(double noise_mm, double stray_share, std::mt19937& random)
        : noise_mm_(noise_mm), stray_share_(stray_share), random_(random) {}
    struct Spoilt {
        double mm = 0;  ///< along the ray
        bool stray = false;
    };
    Spoilt next();

private:
    double noise_mm_, stray_share_;
    std::mt19937& random_;
    std::normal_distribution<double> normal_;
    std::uniform_real_distribution<double> unit_;
};

/// A place, and six 40 mm round it.
std::vector<Eigen::Vector3d> targets_round(const Eigen::Vector3d& deep);

}  // namespace planlight::test
