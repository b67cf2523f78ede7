#include "registration/matching/contact_triplets.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <optional>
#include <random>
#include <utility>

#include "planning_io/types/statistics.h"
#include "registration/matching/match_kernels.h"

namespace planlight {
namespace {

using Eigen::Matrix3f;
using Eigen::Vector3f;

constexpr float kNormalTolerance = 0.28f;  // in a cosine: about 16 degrees across, 40 along

float half_width(const std::vector<SurfaceSite>& sites) {
    Vector3f mean = Vector3f::Zero();
    for (const SurfaceSite& s : sites) mean += s.position / static_cast<float>(sites.size());
    float sum = 0;
    for (const SurfaceSite& s : sites) sum += (s.position - mean).squaredNorm() / static_cast<float>(sites.size());
    return 1.41f * std::sqrt(sum);  // of an even disc: rms radius = R / sqrt 2
}

/// How well three points with normals determine a pose; negative when they must not be a base.
float base_quality(const Base& base, float half_width_mm) {
    std::array<float, 3> sides{}, turns{};
    for (std::size_t i = 0; i < 3; ++i) {
        const auto& a = base[i];
        const auto& b = base[(i + 1) % 3];
        sides[i] = (a.position - b.position).norm() / half_width_mm;
        turns[i] = (a.normal - b.normal).norm();
    }
    const auto [shortest, longest] = std::minmax_element(sides.begin(), sides.end());
    if (*shortest < 0.45f || *longest > 1.5f) return -1;
    const float unequal =
        std::min({std::abs(sides[0] - sides[1]), std::abs(sides[1] - sides[2]), std::abs(sides[2] - sides[0])});
    return *shortest + 0.5f * *std::min_element(turns.begin(), turns.end()) + std::min(unequal, 0.3f);
}

/// Axes of a triangle: along its first side, in its plane, across it.
Matrix3f triangle_axes(const Vector3f& a, const Vector3f& b, const Vector3f& c) {
    Matrix3f axes;
    axes.col(0) = (b - a).normalized();
    axes.col(2) = (b - a).cross(c - a).normalized();
    axes.col(1) = axes.col(2).cross(axes.col(0));
    return axes;
}

bool same_shape(const SkinPairs::Shape& a, const SkinPairs::Shape& b, float tolerance_mm) {
    return std::abs(a.length_mm - b.length_mm) < tolerance_mm && std::abs(a.first - b.first) < kNormalTolerance &&
           std::abs(a.second - b.second) < kNormalTolerance && std::abs(a.between - b.between) < kNormalTolerance;
}

/// The best of `tries` random triples.
std::optional<Base> best_of(const std::vector<SurfaceSite>& sites, int tries, std::mt19937& random) {
    std::optional<Base> best;
    if (sites.size() < 10) return best;
    const float half = half_width(sites);
    float best_quality = 0;
    for (int t = 0; t < tries; ++t) {
        const Base base{sites[random() % sites.size()], sites[random() % sites.size()], sites[random() % sites.size()]};
        const float quality = base_quality(base, half);
        if (quality <= best_quality) continue;
        best = base;
        best_quality = quality;
    }
    return best;
}

/// The sites on one side of a plane through their middle, of random direction.
std::vector<SurfaceSite> random_half(const std::vector<SurfaceSite>& sites, std::mt19937& random) {
    std::normal_distribution<float> any;
    const float x = any(random), y = any(random), z = any(random);
    const Vector3f way(x, y, z);
    std::vector<float> along;
    for (const SurfaceSite& s : sites) along.push_back(s.position.dot(way));
    std::vector<float> sorted = along;
    const auto middle = median(sorted);
    std::vector<SurfaceSite> half;
    for (std::size_t i = 0; i < sites.size(); ++i)
        if (along[i] >= middle) half.push_back(sites[i]);
    return half;
}

}  // namespace

std::vector<Base> choose_bases(const std::vector<SurfaceSite>& sites, int count, unsigned seed) {
    constexpr int kWide = 4, kManyTries = 400, kFewTries = 30;
    std::vector<Base> bases;
    std::vector<SurfaceSite> usable;
    std::copy_if(sites.begin(), sites.end(), std::back_inserter(usable),
                 [](const SurfaceSite& s) { return s.contact; });
    std::mt19937 random(seed);
    for (int i = 0; i < count; ++i) {
        const bool of_all = i < kWide || i % 2 == 0;
        const auto base =
            best_of(of_all ? usable : random_half(usable, random), i < kWide ? kManyTries : kFewTries, random);
        if (base) bases.push_back(*base);
    }
    return bases;
}

SkinPairs::Shape SkinPairs::shape_of(const SurfaceSite& a, const SurfaceSite& b) {
    const Vector3f side = b.position - a.position;
    const float length_mm = side.norm();
    const Vector3f way = length_mm > 0 ? Vector3f(side / length_mm) : Vector3f::Zero();
    return {length_mm, a.normal.dot(way), b.normal.dot(way), a.normal.dot(b.normal)};
}

SkinPairs::SkinPairs(std::vector<SurfaceSite> skin, std::size_t most_kept)
    : skin_(std::move(skin)), kept_(skin_.size() <= most_kept) {
    if (!kept_) return;
    const std::size_t n = skin_.size();
    for (auto* values : {&length_, &first_, &second_, &between_}) values->reserve(n * n);
    for (const SurfaceSite& a : skin_)
        for (const SurfaceSite& b : skin_) {
            const Shape shape = shape_of(a, b);
            length_.push_back(shape.length_mm);
            first_.push_back(shape.first);
            second_.push_back(shape.second);
            between_.push_back(shape.between);
        }
}

SkinPairs::Shape SkinPairs::shape(std::size_t a, std::size_t b) const {
    if (!kept_) return shape_of(skin_[a], skin_[b]);
    const std::size_t at = a * skin_.size() + b;
    return {length_[at], first_[at], second_[at], between_[at]};
}

void SkinPairs::find_alike(const Shape& wanted, std::size_t a, float tolerance_mm, std::vector<int>& found) const {
    constexpr std::size_t kBlock = 256;
    const std::size_t n = skin_.size();
    if (!kept_) {
        for (std::size_t b = 0; b < n; ++b)
            if (same_shape(wanted, shape(a, b), tolerance_mm)) found.push_back(static_cast<int>(b));
        return;
    }
    std::uint8_t marks[kBlock];
    for (std::size_t from = 0; from < n; from += kBlock) {
        const std::size_t m = std::min(kBlock, n - from), at = a * n + from;
        match_kernels::mark_alike(
            &length_[at], &first_[at], &second_[at], &between_[at], m,
            {wanted.length_mm, wanted.first, wanted.second, wanted.between, tolerance_mm, kNormalTolerance}, marks);
        for (std::size_t i = 0; i < m; ++i)
            if (marks[i]) found.push_back(static_cast<int>(from + i));
    }
}

void SkinPairs::find_alike(const Shape& wanted, std::size_t a, float tolerance_mm, std::span<const int> among,
                           std::vector<int>& found) const {
    for (const int b : among)
        if (same_shape(wanted, shape(a, static_cast<std::size_t>(b)), tolerance_mm)) found.push_back(b);
}

void for_each_contact_triplet(const Base& base, const SkinPairs& pairs, double tolerance_mm,
                              const std::function<void(const ContactPose&)>& found) {
    const auto& [a, b, c] = base;
    const auto tolerance = static_cast<float>(tolerance_mm);
    const auto ab = SkinPairs::shape_of(a, b), ac = SkinPairs::shape_of(a, c), bc = SkinPairs::shape_of(b, c);
    const Matrix3f axes = triangle_axes(a.position, b.position, c.position);
    const Vector3f centre = (a.position + b.position + c.position) / 3;
    const Vector3f across(a.normal.dot(axes.col(2)), b.normal.dot(axes.col(2)), c.normal.dot(axes.col(2)));
    const auto& skin = pairs.skin();
    std::vector<int> ring_b, ring_c, thirds;
    for (std::size_t i = 0; i < skin.size(); ++i) {
        const SurfaceSite& A = skin[i];
        ring_b.clear();
        ring_c.clear();
        pairs.find_alike(ab, i, tolerance, ring_b);
        if (!ring_b.empty()) pairs.find_alike(ac, i, tolerance, ring_c);
        for (const int j : ring_b) {
            const SurfaceSite& B = skin[static_cast<std::size_t>(j)];
            thirds.clear();
            pairs.find_alike(bc, static_cast<std::size_t>(j), tolerance, ring_c, thirds);
            for (const int k : thirds) {
                const SurfaceSite& C = skin[static_cast<std::size_t>(k)];
                const Matrix3f skin_axes = triangle_axes(A.position, B.position, C.position);
                const Vector3f skin_across(A.normal.dot(skin_axes.col(2)), B.normal.dot(skin_axes.col(2)),
                                           C.normal.dot(skin_axes.col(2)));
                if ((skin_across - across).cwiseAbs().maxCoeff() > kNormalTolerance) continue;
                ContactPose pose;
                pose.R = skin_axes * axes.transpose();
                pose.t = (A.position + B.position + C.position) / 3 - pose.R * centre;
                found(pose);
            }
        }
    }
}

}  // namespace planlight
