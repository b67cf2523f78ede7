#include "tests/segmentation/synthetic_scan.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/support/analytic_head.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

constexpr double kBlur_mm = 0.8, kAir = -1000, kSoft = 40;

/// Share of matter at a signed distance from a flat edge seen through the blur.
double share(double distance_mm) {
    return 0.5 * std::erfc(distance_mm / kBlur_mm / std::sqrt(2.0));
}

double tube(const Vector3d& p, const Vector3d& a, const Vector3d& b, double radius) {
    const double f = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
    return (p - a - f * (b - a)).norm() - radius;
}

double box(const Vector3d& p, const Vector3d& low, const Vector3d& high) {
    const Vector3d q = (p - (low + high) / 2).cwiseAbs() - (high - low) / 2;
    return q.cwiseMax(0).norm() + std::min(q.maxCoeff(), 0.0);
}

double openings(const Vector3d& p) {
    double d = (p - Vector3d(1, -55, -30)).norm() - 14;
    for (const double side : {-1.0, 1.0})
        d = std::min(d, tube(p, {1 + 6 * side, -98, -75}, {1 + 5 * side, -60, -32}, 3));
    d = std::min(d, tube(p, {1, -50, -30}, {1, -40, -140}, 8));
    d = std::min(d, tube(p, {110, 12, -12}, {45, 10, -10}, 2.5));
    return std::min(d, tube(p, {-110, 15, -7}, {-45, 12, -8}, 2.5));
}

double objects_hu(const Vector3d& p) {
    double hu = kAir;
    const auto add = [&](double distance, double matter) {
        hu = std::max(hu, kAir + (matter - kAir) * share(distance));
    };
    add(box(p, {-104, 118, -300}, {104, 126, 300}), -50);     // table
    add(box(p, {-60, 100, -60}, {60, 118, 100}), -750);       // cushion, under the threshold
    add(box(p, {88, -45, -300}, {91.5, 118, 60}), 100);       // left plate, on the ear
    add(box(p, {-95, -45, -300}, {-91.5, 118, 60}), 100);     // right plate
    add(tube(p, {-140, 10, 110}, {140, 10, 110}, 1.2), 800);  // wire on the crown
    return hu;
}

}  // namespace

double crossing_distance_mm(double hu) {
    double low = -5, high = 5;
    for (int i = 0; i < 60; ++i) {
        const double middle = (low + high) / 2;
        (kAir + (kSoft - kAir) * share(middle) > hu ? low : high) = middle;
    }
    return low;
}

Volume synthetic_scan(const ScanOptions& options) {
    Volume volume;
    volume.is_hu = true;
    volume.modality = "CT";
    const Vector3d low(-108, -128, kCutZ_mm), high(108, 130, 122);
    volume.ct_from_voxel.linear() = options.ct_from_scan * Eigen::Matrix3d(options.spacing_mm.asDiagonal());
    volume.ct_from_voxel.translation() = options.ct_from_scan * low;
    for (int a = 0; a < 3; ++a)
        volume.size[static_cast<std::size_t>(a)] = static_cast<int>((high[a] - low[a]) / options.spacing_mm[a]) + 1;
    std::mt19937 random(7);
    std::normal_distribution<double> noise(0, options.noise_hu > 0 ? options.noise_hu : 1);
    for (int k = 0; k < volume.size[2]; ++k)
        for (int j = 0; j < volume.size[1]; ++j)
            for (int i = 0; i < volume.size[0]; ++i) {
                const Vector3d p = low + options.spacing_mm.cwiseProduct(Vector3d(i, j, k));
                double hu = kAir + (kSoft - kAir) * share(analytic_head_distance(p));
                if (options.openings) hu = kAir + (hu - kAir) * (1 - share(openings(p)));
                if (options.objects) hu = std::max(hu, objects_hu(p));
                if (options.noise_hu > 0) hu += noise(random);
                volume.values.push_back(static_cast<float>(hu));
            }
    return volume;
}

}  // namespace planlight::test
