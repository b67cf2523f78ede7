#include "registration/matching/contact_triplets.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>

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
    const float unequal = std::min({std::abs(sides[0] - sides[1]), std::abs(sides[1] - sides[2]), std::abs(sides[2] - sides[0])});
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

struct PairShape {
    float length, first, second, between;  // side; cosines of both normals with it and with each other
};

PairShape shape_of(const SurfaceSite& a, const SurfaceSite& b) {
    const Vector3f side = b.position - a.position;
    const float length = side.norm();
    return {length, a.normal.dot(side) / length, b.normal.dot(side) / length, a.normal.dot(b.normal)};
}

bool alike(const PairShape& wanted, const SurfaceSite& a, const SurfaceSite& b, float tolerance_mm) {
    const Vector3f side = b.position - a.position;
    const float low = wanted.length - tolerance_mm, high = wanted.length + tolerance_mm;
    const float squared = side.squaredNorm();
    if (squared < low * low || squared > high * high) return false;
    const float length = std::sqrt(squared);
    return std::abs(a.normal.dot(side) - wanted.first * length) < kNormalTolerance * length &&
           std::abs(b.normal.dot(side) - wanted.second * length) < kNormalTolerance * length &&
           std::abs(a.normal.dot(b.normal) - wanted.between) < kNormalTolerance;
}

}  // namespace

std::vector<Base> choose_bases(const std::vector<SurfaceSite>& sites, int count, unsigned seed) {
    constexpr int kTries = 400;
    std::vector<Base> bases;
    std::vector<SurfaceSite> usable;
    std::copy_if(sites.begin(), sites.end(), std::back_inserter(usable), [](const SurfaceSite& s) { return s.contact; });
    if (usable.size() < 10) return bases;
    const float half = half_width(usable);
    std::mt19937 random(seed);
    for (int i = 0; i < count; ++i) {
        Base best;
        float best_quality = 0;
        for (int t = 0; t < kTries; ++t) {
            const Base base{usable[random() % usable.size()], usable[random() % usable.size()], usable[random() % usable.size()]};
            const float quality = base_quality(base, half);
            if (quality <= best_quality) continue;
            best = base;
            best_quality = quality;
        }
        if (best_quality > 0) bases.push_back(best);
    }
    return bases;
}

void for_each_contact_triplet(const Base& base, std::span<const SurfaceSite> skin, double tolerance_mm,
                              const std::function<void(const ContactPose&)>& found) {
    const auto& [a, b, c] = base;
    const auto tolerance = static_cast<float>(tolerance_mm);
    const PairShape ab = shape_of(a, b), ac = shape_of(a, c), bc = shape_of(b, c);
    const Matrix3f axes = triangle_axes(a.position, b.position, c.position);
    const Vector3f centre = (a.position + b.position + c.position) / 3;
    const Vector3f across(a.normal.dot(axes.col(2)), b.normal.dot(axes.col(2)), c.normal.dot(axes.col(2)));
    std::vector<const SurfaceSite*> ring_b, ring_c;
    for (const SurfaceSite& A : skin) {
        ring_b.clear();
        ring_c.clear();
        for (const SurfaceSite& other : skin) {
            if (alike(ab, A, other, tolerance)) ring_b.push_back(&other);
            if (alike(ac, A, other, tolerance)) ring_c.push_back(&other);
        }
        for (const SurfaceSite* B : ring_b)
            for (const SurfaceSite* C : ring_c) {
                if (!alike(bc, *B, *C, tolerance)) continue;
                const Matrix3f skin_axes = triangle_axes(A.position, B->position, C->position);
                const Vector3f skin_across(A.normal.dot(skin_axes.col(2)), B->normal.dot(skin_axes.col(2)),
                                           C->normal.dot(skin_axes.col(2)));
                if ((skin_across - across).cwiseAbs().maxCoeff() > kNormalTolerance) continue;
                ContactPose pose;
                pose.R = skin_axes * axes.transpose();
                pose.t = (A.position + B->position + C->position) / 3 - pose.R * centre;
                found(pose);
            }
    }
}

}  // namespace planlight
