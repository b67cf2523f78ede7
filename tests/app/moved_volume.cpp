#include "tests/app/moved_volume.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <stdexcept>

namespace planlight::test {
namespace {

using Eigen::Vector3d;

float value_at(const Volume& volume, const Vector3d& voxel) {
    const auto clamped = [&](double v, std::size_t axis) {
        return std::clamp(v, 0., static_cast<double>(volume.size[axis]) - 1.001);
    };
    const double x = clamped(voxel.x(), 0), y = clamped(voxel.y(), 1), z = clamped(voxel.z(), 2);
    const int i = static_cast<int>(x), j = static_cast<int>(y), k = static_cast<int>(z);
    const double a = x - i, b = y - j, c = z - k;
    double sum = 0;
    for (int n = 0; n < 8; ++n) {
        const int di = n & 1, dj = (n >> 1) & 1, dk = n >> 2;
        sum += (di ? a : 1 - a) * (dj ? b : 1 - b) * (dk ? c : 1 - c) * volume.at(i + di, j + dj, k + dk);
    }
    return static_cast<float>(sum);
}

std::function<double(const Vector3d&)> height_of(const std::string& how, double size_mm, const Vector3d& where,
                                                 unsigned seed) {
    if (how == "thinner") return [=](const Vector3d&) { return -size_mm; };
    if (how == "swelling")
        return [=](const Vector3d& p) { return size_mm * std::exp(-(p - where).squaredNorm() / (2 * 25. * 25.)); };
    if (how != "waves") throw std::invalid_argument("skin moves by still, waves, swelling or thinner");
    std::mt19937 random(seed);
    std::normal_distribution<double> unit;
    const auto wave = [&](double length_mm) {
        const Vector3d along =
            Vector3d(unit(random), unit(random), unit(random)).normalized() * (2 * std::numbers::pi / length_mm);
        const double phase = 2 * unit(random);
        return [=](const Vector3d& p) { return std::sin(along.dot(p) + phase); };
    };
    const auto a = wave(60), b = wave(35);
    return [=](const Vector3d& p) { return size_mm * (0.6 * a(p) + 0.4 * b(p)); };
}

}  // namespace

Volume with_moved_skin(const Volume& volume, const std::string& how, double size_mm, const Vector3d& where_in_ct,
                       unsigned seed) {
    if (how == "still") return volume;
    const auto height = height_of(how, size_mm, where_in_ct, seed);
    const Vector3d last(volume.size[0] - 1, volume.size[1] - 1, volume.size[2] - 1);
    const Vector3d middle = volume.ct_from_voxel * (last / 2);
    const Eigen::Affine3d voxel_from_ct = volume.ct_from_voxel.inverse();
    Volume moved = volume;
    std::size_t at = 0;
    for (int k = 0; k < volume.size[2]; ++k)
        for (int j = 0; j < volume.size[1]; ++j)
            for (int i = 0; i < volume.size[0]; ++i, ++at) {
                const Vector3d p = volume.ct_from_voxel * Vector3d(i, j, k);
                const Vector3d out = (p - middle).normalized();
                if (out.allFinite()) moved.values[at] = value_at(volume, voxel_from_ct * (p - height(p) * out));
            }
    return moved;
}

}  // namespace planlight::test
