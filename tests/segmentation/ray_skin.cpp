#include "tests/segmentation/ray_skin.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "planning_io/types/statistics.h"
#include "planning_io/volume/volume_sample.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

constexpr double kBeginsInHead = -1;  // of a ray: where the volume does, the head does

constexpr double kBetween_mm = 4, kStep_mm = 0.5;
constexpr int kLeastAir = 12, kStays = 6;         // samples: 6 mm of air, 3 mm above it
constexpr double kBefore_mm = 6, kBehind_mm = 8;  // of that place, where the edge is sought along the normal
constexpr int kDeeper = 4;                        // samples: 2 mm of skin lie over the fat
constexpr double kSteepest = 2;                   // mm of depth a mm aside: 63 degrees
constexpr int kBesideCut = 5;                     // rays
constexpr int kThin = 24, kGap = 6;               // samples: what is thinner with so much air behind is no skin (CT)
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

/// Of a profile along the normal: the first place whose value above the air is half of the one 2 mm deeper, mm. Not the
/// half of the brightest that follows: under the skin of a T1 lies fat two or three times as bright as the skin itself
/// (2 to 3 mm thick on a scalp), and in a CT under a thin scalp the bone, so that the half of that crest lies within
/// the skin or under it.
double edge_at(const std::vector<double>& profile, double air, double level, std::size_t deeper) {
    for (std::size_t n = 1; n + deeper < profile.size(); ++n) {
        const double before = profile[n - 1] - air - (profile[n - 1 + deeper] - air) / 2,
                     now = profile[n] - air - (profile[n + deeper] - air) / 2;
        if (profile[n + deeper] > level && now >= 0)
            return before < 0 ? kStep_mm * (static_cast<double>(n) - now / (now - before)) : NAN;
    }
    return NAN;
}

/// Whether air follows close behind: a couch, a mask, the rim of an ear. To be asked of a CT only, where bone is no
/// air.
bool is_thin(const std::vector<double>& profile, std::size_t above, double level) {
    int gap = 0;
    for (std::size_t n = above; n < std::min(above + kThin + kGap, profile.size()); ++n) {
        gap = profile[n] < level ? gap + 1 : 0;
        if (gap >= kGap) return true;
    }
    return false;
}

/// Where a ray leaves the air that it has seen.
struct Exit {
    double depth_mm = NAN;  ///< along the ray; not a number where it sees no air first, or nothing but air
    double air = 0, level = 0;
};

Exit exit_of(const std::vector<double>& profile, double contrast, bool air_behind) {
    std::vector<double> air;
    for (std::size_t s = 0; s + kStays < profile.size(); ++s) {
        if (!std::isfinite(profile[s])) {
            if (!air.empty()) return {};
            continue;
        }
        if (static_cast<int>(air.size()) >= kLeastAir) {
            std::vector<double> last(air.size() > 60 ? air.end() - 60 : air.begin(), air.end() - 4);
            const double middle = median(last);
            for (double& a : last) a = std::abs(a - middle);
            const double level = middle + std::max(kDeviations * 1.4826 * median(last), 0.15 * contrast);
            bool stays = true;
            for (std::size_t n = s; n < s + kStays; ++n) stays = stays && profile[n] > level;
            if (stays && air_behind && is_thin(profile, s, level)) return {};
            if (stays) return {kStep_mm * static_cast<double>(s), middle, level};
        } else if (static_cast<int>(air.size()) >= 4 && profile[s] > median(air) + 0.3 * contrast) {
            return {kBeginsInHead};
        }
        air.push_back(profile[s]);
    }
    return {};
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
        std::vector<Exit> exits(static_cast<std::size_t>((2 * n + 1) * (2 * n + 1)));
        const auto start = [&](int a, int b) -> Vector3d {
            return box.center() + half * side + kBetween_mm * (a * u + b * v);
        };
        tbb::parallel_for(-n, n + 1, [&](int a) {
            for (int b = -n; b <= n; ++b)
                exits[at(a, b)] = exit_of(
                    profile_of(volume, voxel_from_ct, start(a, b), -side, u, v, static_cast<int>(2 * half / kStep_mm)),
                    contrast, volume.is_hu);
        });
        const auto depth = [&](int a, int b) { return exits[at(a, b)].depth_mm; };
        // Near a cut side what is dark there (a sinus, an ear's canal, bone) is no air.
        const auto beside_cut = [&](int a, int b) {
            for (int i = std::max(-n, a - kBesideCut); i <= std::min(n, a + kBesideCut); ++i)
                for (int j = std::max(-n, b - kBesideCut); j <= std::min(n, b + kBesideCut); ++j)
                    if (depth(i, j) == kBeginsInHead) return true;
            return false;
        };
        for (int a = -n + 1; a < n; ++a)
            for (int b = -n + 1; b < n; ++b) {
                const double here = depth(a, b);
                int alike = 0;
                for (const auto& [da, db] : {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)})
                    alike += std::abs(depth(a + da, b + db) - here) < kLoneliest_mm;
                if (!std::isfinite(here) || alike < 3 || beside_cut(a, b)) continue;
                const auto slope = [&](double before, double after) {  // of two neighbours, or of the one that is there
                    const double low = here - before, high = after - here;
                    const bool has_low = std::abs(low) < kLoneliest_mm, has_high = std::abs(high) < kLoneliest_mm;
                    return (has_low && has_high ? (low + high) / 2 : has_low ? low : high) / kBetween_mm;
                };
                const double along_u = slope(depth(a - 1, b), depth(a + 1, b)),
                             along_v = slope(depth(a, b - 1), depth(a, b + 1));
                if (std::hypot(along_u, along_v) > kSteepest) continue;
                const Vector3d inwards = -(side + along_u * u + along_v * v).normalized(),
                               from = start(a, b) - here * side - kBefore_mm * inwards, p = inwards.unitOrthogonal();
                const double voxel_mm = (volume.ct_from_voxel.linear().transpose() * inwards).cwiseAbs().maxCoeff();
                const auto profile = profile_of(volume, voxel_from_ct, from, inwards, p, inwards.cross(p),
                                                static_cast<int>((kBefore_mm + kBehind_mm) / kStep_mm));
                const double edge_mm =
                    edge_at(profile, exits[at(a, b)].air, exits[at(a, b)].level,
                            static_cast<std::size_t>(std::max<double>(kDeeper, 0.6 * voxel_mm / kStep_mm)));
                if (std::isfinite(edge_mm)) points.push_back(from + edge_mm * inwards);
            }
    }
    return points;
}

}  // namespace planlight::test
