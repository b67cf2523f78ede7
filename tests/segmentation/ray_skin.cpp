#include "tests/segmentation/ray_skin.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "planning_io/types/statistics.h"
#include "segmentation/volume_sample.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

constexpr double kBetween_mm = 4, kStep_mm = 0.5;
constexpr int kLeastAir = 12, kStays = 6, kCrest = 14;  // samples: 6 mm of air, 3 mm above it, 7 mm to the crest
constexpr double kDeviations = 8, kLoneliest_mm = 5;

/// The mean of five rays 1.2 mm aside, and of 1.5 mm along.
std::vector<double> profile_of(const Volume& volume, const Eigen::Affine3d& voxel_from_ct, const Vector3d& from,
                               const Vector3d& along, const Vector3d& u, const Vector3d& v, int samples) {
    std::vector<double> raw(static_cast<std::size_t>(samples), NAN);
    for (int s = 0; s < samples; ++s) {
        double sum = 0;
        int count = 0;
        for (const Vector3d& aside :
             {Vector3d(Vector3d::Zero()), Vector3d(1.2 * u), Vector3d(-1.2 * u), Vector3d(1.2 * v), Vector3d(-1.2 * v)})
            if (const auto value = value_at(volume, voxel_from_ct * (from + s * kStep_mm * along + aside));
                value && std::isfinite(*value))
                sum += *value, ++count;
        if (count >= 3) raw[static_cast<std::size_t>(s)] = sum / count;
    }
    std::vector<double> result = raw;
    for (std::size_t s = 1; s + 1 < raw.size(); ++s) result[s] = (raw[s - 1] + raw[s] + raw[s + 1]) / 3;
    return result;
}

/// How far along the profile the skin is, mm; not a number where the ray sees no air first, or nothing but air.
double skin_at(const std::vector<double>& profile, double contrast) {
    std::vector<double> air;
    for (std::size_t s = 0; s + kStays < profile.size(); ++s) {
        if (!std::isfinite(profile[s])) {
            if (!air.empty()) return NAN;
            continue;
        }
        if (static_cast<int>(air.size()) >= kLeastAir) {
            std::vector<double> last(air.size() > 60 ? air.end() - 60 : air.begin(), air.end() - 4);
            const double middle = median(last);
            for (double& a : last) a = std::abs(a - middle);
            const double level = middle + std::max(kDeviations * 1.4826 * median(last), 0.15 * contrast);
            bool stays = true;
            for (std::size_t n = s; n < s + kStays; ++n) stays = stays && profile[n] > level;
            if (stays) {
                double crest = profile[s];
                for (std::size_t n = s; n < std::min(s + kCrest, profile.size()) && profile[n] > 0.85 * crest; ++n)
                    crest = std::max(crest, profile[n]);
                const double half = (middle + crest) / 2;
                std::size_t n = s;
                while (n + 1 < profile.size() && profile[n] < half) ++n;
                return kStep_mm * static_cast<double>(n);
            }
        } else if (static_cast<int>(air.size()) >= 4 && profile[s] > median(air) + 0.3 * contrast) {
            return NAN;  // the head begins where the volume does
        }
        air.push_back(profile[s]);
    }
    return NAN;
}

double contrast_of(const Volume& volume) {
    std::vector<float> sample;
    for (std::size_t v = 0; v < volume.values.size(); v += 61)
        if (std::isfinite(volume.values[v])) sample.push_back(volume.values[v]);
    return static_cast<double>(quantile(sample, 0.9) - quantile(sample, 0.1));
}

}  // namespace

std::vector<Vector3d> ray_skin(const Volume& volume) {
    Eigen::AlignedBox3d box;
    for (int corner = 0; corner < 8; ++corner)
        box.extend(volume.ct_from_voxel * Vector3d((corner & 1) * (volume.size[0] - 1),
                                                   ((corner >> 1) & 1) * (volume.size[1] - 1),
                                                   (corner >> 2) * (volume.size[2] - 1)));
    const Eigen::Affine3d voxel_from_ct = volume.ct_from_voxel.inverse();
    const double contrast = contrast_of(volume), half = box.diagonal().norm() / 2;
    std::vector<Vector3d> sides, points;
    for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
            for (int z = -1; z <= 1; ++z)
                if (const int n = std::abs(x) + std::abs(y) + std::abs(z); (n == 1 || n == 3) && z >= 0)
                    sides.push_back(Vector3d(x, y, z).normalized());
    for (const Vector3d& side : sides) {
        const Vector3d u = side.unitOrthogonal(), v = side.cross(u);
        const int n = static_cast<int>(half / kBetween_mm);
        const auto at = [&](int a, int b) { return static_cast<std::size_t>((a + n) * (2 * n + 1) + b + n); };
        std::vector<double> depth(static_cast<std::size_t>((2 * n + 1) * (2 * n + 1)), NAN);
        const auto start = [&](int a, int b) -> Vector3d {
            return box.center() + half * side + kBetween_mm * (a * u + b * v);
        };
        tbb::parallel_for(-n, n + 1, [&](int a) {
            for (int b = -n; b <= n; ++b)
                depth[at(a, b)] = skin_at(
                    profile_of(volume, voxel_from_ct, start(a, b), -side, u, v, static_cast<int>(2 * half / kStep_mm)),
                    contrast);
        });
        for (int a = -n + 1; a < n; ++a)
            for (int b = -n + 1; b < n; ++b) {
                const double here = depth[at(a, b)];
                int alike = 0;
                for (const auto& [da, db] : {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)})
                    alike += std::abs(depth[at(a + da, b + db)] - here) < kLoneliest_mm;
                if (std::isfinite(here) && alike >= 3) points.push_back(start(a, b) - here * side);
            }
    }
    return points;
}

}  // namespace planlight::test
