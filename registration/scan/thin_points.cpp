#include "registration/scan/thin_points.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace planlight {
namespace {

constexpr std::uint64_t kSide = 1 << 20;  // cubes along an axis
constexpr std::uint64_t kNone = ~std::uint64_t{0};

/// The points by the cube they lie in: a hash table of the cubes, and in each the point nearest to its centre.
class Cubes {
public:
    Cubes(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3f& low)
        : points_(points), low_(low), keys_(std::bit_ceil(2 * points.size())), nearest_(keys_.size()), off_(keys_.size()) {}

    /// Sorts the points into cubes of this edge; how many cubes hold one.
    std::size_t count(float edge_mm) {
        std::fill(keys_.begin(), keys_.end(), kNone);
        std::size_t cubes = 0;
        for (const Eigen::Vector3f& p : points_) {
            const std::uint64_t key = key_of((p - low_) / edge_mm);
            std::uint64_t& slot = keys_[place_of(key)];
            cubes += slot == kNone;
            slot = key;
        }
        return cubes;
    }

    /// One point per cube, in ascending order.
    std::vector<std::size_t> nearest(float edge_mm) {
        std::fill(keys_.begin(), keys_.end(), kNone);
        std::vector<std::size_t> places;
        for (std::size_t i = 0; i < points_.size(); ++i) {
            const Eigen::Vector3f scaled = (points_[i] - low_) / edge_mm;
            const float off = (scaled.array() - scaled.array().floor() - 0.5f).square().sum();
            const std::uint64_t key = key_of(scaled);
            const std::size_t place = place_of(key);
            if (keys_[place] == kNone) places.push_back(place);
            else if (off_[place] <= off) continue;
            keys_[place] = key;
            nearest_[place] = static_cast<std::uint32_t>(i);
            off_[place] = off;
        }
        std::vector<bool> kept(points_.size(), false);
        for (const std::size_t place : places) kept[nearest_[place]] = true;
        std::vector<std::size_t> indices;
        indices.reserve(places.size());
        for (std::size_t i = 0; i < kept.size(); ++i)
            if (kept[i]) indices.push_back(i);
        return indices;
    }

private:
    static std::uint64_t key_of(const Eigen::Vector3f& scaled) {
        return static_cast<std::uint64_t>(scaled.x()) +
               kSide * (static_cast<std::uint64_t>(scaled.y()) + kSide * static_cast<std::uint64_t>(scaled.z()));
    }
    /// Where the cube is in the table, or the free place for it.
    std::size_t place_of(std::uint64_t key) const {
        const std::size_t mask = keys_.size() - 1;
        std::size_t place = static_cast<std::size_t>((key * 0x9E3779B97F4A7C15u) >> 40) & mask;
        while (keys_[place] != key && keys_[place] != kNone) place = (place + 1) & mask;
        return place;
    }

    const std::vector<Eigen::Vector3f>& points_;
    Eigen::Vector3f low_;
    std::vector<std::uint64_t> keys_;
    std::vector<std::uint32_t> nearest_;
    std::vector<float> off_;
};

}  // namespace

std::vector<std::size_t> thin_evenly(const std::vector<Eigen::Vector3f>& points, std::size_t max_points) {
    if (points.size() <= max_points) {
        std::vector<std::size_t> all(points.size());
        std::iota(all.begin(), all.end(), std::size_t{0});
        return all;
    }
    Eigen::Vector3f low = points[0], high = points[0];
    for (const auto& p : points) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    const float size = std::max((high - low).maxCoeff(), 1e-6f);
    float fine = size / (static_cast<float>(kSide) / 2), coarse = 2 * size;  // coarse: one cube
    Cubes cubes(points, low);
    // A surface's cubes go with the inverse square of their edge: start there, then bisect on the logarithm.
    float edge = size / std::sqrt(static_cast<float>(max_points));
    for (int step = 0; step < 24 && coarse > 1.01f * fine; ++step) {
        const float ratio = static_cast<float>(cubes.count(edge)) / static_cast<float>(max_points);
        if (ratio <= 1) {
            coarse = edge;
            if (ratio > 0.98f) break;
        } else {
            fine = edge;
        }
        const float guess = edge * std::sqrt(std::max(ratio, 1e-6f) / 0.99f);
        edge = guess > fine * 1.001f && guess < coarse * 0.999f ? guess : std::sqrt(fine * coarse);
    }
    return cubes.nearest(coarse);
}

}  // namespace planlight
