#include "registration/scan/thin_points.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <tuple>
#include <utility>

namespace planlight {
namespace {

constexpr std::int64_t kSide = 1 << 20;  // cubes along an axis

/// One point per cube: the one nearest to the cube's centre.
std::vector<std::size_t> one_per_cube(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& low, double edge_mm) {
    struct Entry {
        std::int64_t cube;
        double off;
        std::size_t index;
    };
    std::vector<Entry> entries(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Eigen::Array3d scaled = ((points[i] - low) / edge_mm).array(), whole = scaled.floor();
        const auto cube = static_cast<std::int64_t>(whole.x()) +
                          kSide * (static_cast<std::int64_t>(whole.y()) + kSide * static_cast<std::int64_t>(whole.z()));
        entries[i] = {cube, (scaled - whole - 0.5).square().sum(), i};
    }
    std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
        return std::tie(a.cube, a.off, a.index) < std::tie(b.cube, b.off, b.index);
    });
    std::vector<std::size_t> kept;
    for (std::size_t k = 0; k < entries.size(); ++k)
        if (k == 0 || entries[k].cube != entries[k - 1].cube) kept.push_back(entries[k].index);
    std::sort(kept.begin(), kept.end());
    return kept;
}

}  // namespace

std::vector<std::size_t> thin_evenly(const std::vector<Eigen::Vector3d>& points, std::size_t max_points) {
    std::vector<std::size_t> all(points.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    if (points.size() <= max_points) return all;
    Eigen::Vector3d low = points[0], high = points[0];
    for (const auto& p : points) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    const double size = std::max((high - low).maxCoeff(), 1e-6);
    double fine = size / (kSide / 2), coarse = 2 * size;  // coarse: one cube
    std::vector<std::size_t> best{0};
    // A surface's cubes go with the inverse square of their edge: start there, then bisect on the logarithm.
    double edge = size / std::sqrt(static_cast<double>(max_points));
    for (int step = 0; step < 24 && coarse > 1.01 * fine; ++step) {
        auto kept = one_per_cube(points, low, edge);
        const double ratio = static_cast<double>(kept.size()) / static_cast<double>(max_points);
        if (ratio <= 1) {
            best = std::move(kept);
            coarse = edge;
            if (ratio > 0.98) break;
        } else {
            fine = edge;
        }
        const double guess = edge * std::sqrt(std::max(ratio, 1e-6) / 0.99);
        edge = guess > fine * 1.001 && guess < coarse * 0.999 ? guess : std::sqrt(fine * coarse);
    }
    return best;
}

}  // namespace planlight
