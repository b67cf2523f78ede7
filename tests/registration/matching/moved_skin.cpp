#include "tests/registration/matching/moved_skin.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <stdexcept>

namespace planlight::test {
namespace {

using Eigen::Vector3d;

Vector3d normal_vector(std::mt19937& random) {
    std::normal_distribution<double> any;
    const double x = any(random), y = any(random), z = any(random);
    return {x, y, z};
}

/// A smooth random field of about unit variance, alike over `length_mm`: cosines of random waves (Rahimi & Recht 2007).
std::function<double(const Vector3d&)> smooth_field(double length_mm, std::mt19937& random) {
    constexpr int kWaves = 150;
    std::vector<std::pair<Vector3d, double>> waves;
    std::uniform_real_distribution<double> phase(0, 2 * std::numbers::pi);
    for (int i = 0; i < kWaves; ++i) {
        const Vector3d k = normal_vector(random) / length_mm;
        waves.emplace_back(k, phase(random));
    }
    return [waves](const Vector3d& p) {
        double sum = 0;
        for (const auto& [k, shift] : waves) sum += std::cos(k.dot(p) + shift);
        return sum * std::sqrt(2. / kWaves);
    };
}

/// Three swellings or dents, each 15 to 35 mm wide, somewhere on the cloud.
std::vector<double> swellings(const PointCloud& cloud, std::mt19937& random) {
    std::vector<double> moved(cloud.size(), 0);
    std::uniform_real_distribution<double> width(15, 35), height(0.5, 1.5);
    for (int i = 0; i < 3; ++i) {
        const Vector3d middle = cloud.points_in_rig[random() % cloud.size()];
        const double w = width(random), h = (random() % 3 == 0 ? -1 : 1) * height(random);
        for (std::size_t k = 0; k < moved.size(); ++k)
            moved[k] += h * std::exp(-(cloud.points_in_rig[k] - middle).squaredNorm() / (2 * w * w));
    }
    return moved;
}

/// One side swells broadly, as after an injury: highest somewhere on one side of the cloud, half as high 35 to 60 mm
/// from there.
std::vector<double> swollen_side(const PointCloud& cloud, std::mt19937& random) {
    const Vector3d highest = cloud.points_in_rig[random() % cloud.size()];
    std::uniform_real_distribution<double> half_width_mm(35, 60);
    const double per_mm2 = std::log(2.) / std::pow(half_width_mm(random), 2);
    std::vector<double> moved;
    for (const auto& p : cloud.points_in_rig) moved.push_back(std::exp(-per_mm2 * (p - highest).squaredNorm()));
    return moved;
}

/// Soft skin hangs to where it is drawn: against the normals that face away, more where a slow field says it is thick.
std::vector<double> sagged(const PointCloud& cloud, std::mt19937& random) {
    const Vector3d down = normal_vector(random).normalized();
    const auto thickness = smooth_field(40, random);
    std::vector<double> moved;
    for (std::size_t k = 0; k < cloud.size(); ++k)
        moved.push_back(std::exp(0.7 * thickness(cloud.points_in_rig[k])) * down.dot(cloud.normals_in_rig[k]));
    return moved;
}

/// The soft half of the skin is pulled one way, the other half stays: cheeks and temples against forehead and nose
/// bridge.
std::vector<double> pulled(const PointCloud& cloud, std::mt19937& random) {
    const Vector3d way = normal_vector(random).normalized();
    const auto soft = smooth_field(30, random);
    std::vector<double> moved;
    for (std::size_t k = 0; k < cloud.size(); ++k)
        moved.push_back(way.dot(cloud.normals_in_rig[k]) / (1 + std::exp(-4 * soft(cloud.points_in_rig[k]))));
    return moved;
}

/// One side lies on a headrest: pressed flat there, up to its largest in the middle.
std::vector<double> pressed(const PointCloud& cloud, std::mt19937& random) {
    const Vector3d middle = cloud.points_in_rig[random() % cloud.size()];
    std::vector<double> moved;
    for (const auto& p : cloud.points_in_rig)
        moved.push_back(-std::max(0., 1 - (p - middle).squaredNorm() / (50. * 50)));
    return moved;
}

/// The lower third of the cloud turns as one piece about a left-right axis at its upper end: a jaw.
std::vector<double> opened_jaw(const PointCloud& cloud) {
    std::vector<double> heights;
    for (const auto& p : cloud.points_in_rig) heights.push_back(p.z());
    const auto third = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 3);
    std::nth_element(heights.begin(), third, heights.end());
    const double edge = *third;
    std::vector<double> moved;
    for (std::size_t k = 0; k < cloud.size(); ++k) {
        const double below = std::max(0., edge - cloud.points_in_rig[k].z());
        moved.push_back(-below * cloud.normals_in_rig[k].y());
    }
    return moved;
}

std::vector<double> along_normals(const PointCloud& cloud, const std::string& movement, std::mt19937& random) {
    if (movement == "swellings") return swellings(cloud, random);
    if (movement == kSwollenSide) return swollen_side(cloud, random);
    if (movement == "soft parts pulled") return pulled(cloud, random);
    if (movement == "pressed flat") return pressed(cloud, random);
    if (movement == "sag") return sagged(cloud, random);
    if (movement == "jaw") return opened_jaw(cloud);
    if (movement == "thicker all over") return std::vector<double>(cloud.size(), random() % 2 == 0 ? 1 : -1);
    std::function<double(const Vector3d&)> field, other;
    if (movement == "waves of 25 mm")
        field = smooth_field(25, random);
    else if (movement == "waves of 12 mm")
        field = smooth_field(12, random);
    else if (movement == "waves of 50 mm")
        field = smooth_field(50, random);
    else if (movement == "waves of 8 and 40 mm")
        field = smooth_field(8, random), other = smooth_field(40, random);
    else
        throw std::invalid_argument("no such movement: " + movement);
    std::vector<double> moved;
    for (const auto& p : cloud.points_in_rig) moved.push_back(field(p) + (other ? other(p) : 0));
    return moved;
}

}  // namespace

const std::vector<SkinMovement>& skin_movements() {
    static const std::vector<SkinMovement> all{
        {"waves of 25 mm", true},     {"swellings", true},       {"sag", true},
        {"waves of 12 mm", false},    {"waves of 50 mm", false}, {"waves of 8 and 40 mm", false},
        {"soft parts pulled", false}, {"pressed flat", false},   {"jaw", false},
        {"thicker all over", false}};
    return all;
}

PointCloud with_moved_skin(const PointCloud& cloud_in_ct, const std::string& movement, double rms_mm, unsigned seed) {
    std::mt19937 random(seed);
    const std::vector<double> moved = along_normals(cloud_in_ct, movement, random);
    double squares = 0;
    for (const double m : moved) squares += m * m;
    const double unit = std::sqrt(squares / static_cast<double>(moved.size()));
    PointCloud cloud = cloud_in_ct;
    for (std::size_t i = 0; i < moved.size(); ++i)
        cloud.points_in_rig[i] += rms_mm * moved[i] / std::max(unit, 1e-9) * cloud.normals_in_rig[i];
    return cloud;
}

}  // namespace planlight::test
