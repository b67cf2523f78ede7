#include "registration/scan/clean/voxel_downsample.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

#include "planning_io/types/processor_clones.h"

namespace planlight {
namespace {

constexpr std::size_t kMostCubes = std::size_t{1} << 28;

/// Bits set in the words before each.
PLANLIGHT_CLONES void add_up(const std::uint64_t* words, std::size_t count, std::uint32_t* __restrict before) {
    std::uint32_t sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
        before[i] = sum;
        sum += static_cast<std::uint32_t>(std::popcount(words[i]));
    }
}

PLANLIGHT_CLONES std::uint32_t bits_below(std::uint64_t word, std::uint64_t bit) {
    return static_cast<std::uint32_t>(std::popcount(word & ((std::uint64_t{1} << bit) - 1)));
}

/// The points by the cube they lie in: a bit for each cube of the box around them.
class Cubes {
public:
    Cubes(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3f& low, const Eigen::Vector3f& size)
        : points_(points), low_(low), size_(size) {}

    /// The smallest edge with which the bits do not become too many.
    float finest_mm() const {
        float edge = std::max(size_.maxCoeff(), 1e-6f) / 600;
        while (cubes_of(edge / 2) <= kMostCubes && edge > size_.maxCoeff() * 1e-5f) edge /= 2;
        return edge;
    }

    /// Sorts the points into cubes of this edge; how many cubes hold one.
    std::size_t count(float edge_mm) {
        set_edge(edge_mm);
        words_.assign(cubes_of(edge_mm) / 64 + 1, 0);
        std::size_t cubes = 0;
        for (const Eigen::Vector3f& p : points_) {
            const std::size_t cube = cube_of((p - low_) * by_edge_);
            std::uint64_t& word = words_[cube / 64];
            const std::uint64_t bit = std::uint64_t{1} << (cube % 64);
            cubes += (word & bit) == 0;
            word |= bit;
        }
        return cubes;
    }

    /// The point nearest to the centre of each cube, in ascending order.
    std::vector<std::size_t> nearest(float edge_mm) {
        const std::size_t cubes = count(edge_mm);
        std::vector<std::uint32_t> before(words_.size()), nearest(cubes);
        std::vector<float> least(cubes, std::numeric_limits<float>::infinity());
        add_up(words_.data(), words_.size(), before.data());
        for (std::size_t i = 0; i < points_.size(); ++i) {
            const Eigen::Vector3f scaled = (points_[i] - low_) * by_edge_;
            const float off = (scaled.array() - scaled.array().cast<int>().cast<float>() - 0.5f).square().sum();
            const std::size_t cube = cube_of(scaled),
                              place = before[cube / 64] + bits_below(words_[cube / 64], cube % 64);
            if (off >= least[place]) continue;
            least[place] = off;
            nearest[place] = static_cast<std::uint32_t>(i);
        }
        std::vector<std::uint8_t> kept(points_.size(), 0);
        for (const std::uint32_t i : nearest) kept[i] = 1;
        std::vector<std::size_t> indices;
        indices.reserve(cubes);
        for (std::size_t i = 0; i < kept.size(); ++i)
            if (kept[i]) indices.push_back(i);
        return indices;
    }

private:
    std::size_t along(float length_mm, float edge_mm) const {
        return static_cast<std::size_t>(length_mm / edge_mm) + 2;
    }
    std::size_t cubes_of(float edge_mm) const {
        return along(size_.x(), edge_mm) * along(size_.y(), edge_mm) * along(size_.z(), edge_mm);
    }
    void set_edge(float edge_mm) {
        by_edge_ = 1 / edge_mm;
        columns_ = along(size_.x(), edge_mm);
        rows_ = along(size_.y(), edge_mm);
    }
    std::size_t cube_of(const Eigen::Vector3f& scaled) const {
        return static_cast<std::size_t>(scaled.x()) +
               columns_ * (static_cast<std::size_t>(scaled.y()) + rows_ * static_cast<std::size_t>(scaled.z()));
    }

    const std::vector<Eigen::Vector3f>& points_;
    Eigen::Vector3f low_, size_;
    float by_edge_ = 1;
    std::size_t columns_ = 1, rows_ = 1;
    std::vector<std::uint64_t> words_;
};

}  // namespace

std::vector<std::size_t> voxel_downsample(const std::vector<Eigen::Vector3f>& points, std::size_t max_points) {
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
    Cubes cubes(points, low, high - low);
    float fine = cubes.finest_mm(), coarse = 2 * size;  // coarse: one cube
    // A surface's cubes go with the inverse square of their edge, with less where cubes hold single points: start
    // there, then bisect on the logarithm.
    float edge = std::max(size / std::sqrt(static_cast<float>(max_points)), fine);
    for (int step = 0; step < 24 && coarse > 1.01f * fine; ++step) {
        const float ratio = static_cast<float>(cubes.count(edge)) / static_cast<float>(max_points);
        if (ratio <= 1) {
            coarse = edge;
            if (ratio > 0.98f) break;
        } else {
            fine = edge;
        }
        const float guess = edge * std::pow(std::max(ratio, 1e-6f) / 0.99f, ratio < 1 ? 0.75f : 0.5f);
        edge = guess > fine * 1.001f && guess < coarse * 0.999f ? guess : std::sqrt(fine * coarse);
    }
    return cubes.nearest(coarse);
}

}  // namespace planlight
