#include "planning_io/surface/surface_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "planning_io/types/error.h"
#include "planning_io/types/statistics.h"
#include "planning_io/volume/volume_sample.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr double kLeastInside = 0.95, kLeastDarker = 0.75, kLeastOnEdge = 0.7, kUsuallyOnEdge = 0.85,
                 kAcrossEdge_mm = 1.5, kOnEdge_mm = 2;
constexpr std::size_t kAsked = 6000;

constexpr double kStep_mm = 0.5, kReach_mm = 10;
constexpr int kSteps = static_cast<int>(kReach_mm / kStep_mm);  // each way
constexpr int kAcross = 2;                                      // steps to both sides of a fall
using Profile = std::array<double, 2 * (kSteps + kAcross) + 1>;
using Falls = std::array<double, 2 * kSteps + 1>;

class Sampler {
public:
    explicit Sampler(const Volume& volume) : volume_(volume), voxel_from_ct_(volume.ct_from_voxel.inverse()) {}

    /// NaN beyond the outermost voxel centres.
    double at(const Vector3d& p_in_ct) const { return value_at(volume_, voxel_from_ct_ * p_in_ct).value_or(NAN); }

    bool inside(const Vector3d& p_in_ct) const {
        const Vector3d v = voxel_from_ct_ * p_in_ct;
        for (int axis = 0; axis < 3; ++axis)  // a cut is closed up to a voxel beyond the last one's centre
            if (!(v[axis] >= -1) || v[axis] > volume_.size[static_cast<std::size_t>(axis)]) return false;
        return true;
    }

private:
    const Volume& volume_;
    Eigen::Affine3d voxel_from_ct_;
};

/// By how much the volume falls outwards, at each step along the normal; NaN where it ends. Empty where it ends within
/// what is asked of each place.
std::optional<Falls> falls_at(const Sampler& volume, const Vector3d& p, const Vector3d& normal) {
    Profile values{};
    for (int i = 0; i < static_cast<int>(values.size()); ++i)
        values[static_cast<std::size_t>(i)] = volume.at(p + (i - kSteps - kAcross) * kStep_mm * normal);
    Falls falls{};
    for (std::size_t i = 0; i < falls.size(); ++i) falls[i] = values[i] - values[i + 2 * kAcross];
    constexpr int kNear = static_cast<int>(kOnEdge_mm / kStep_mm);
    for (int i = -kNear; i <= kNear; ++i)
        if (std::isnan(falls[static_cast<std::size_t>(i + kSteps)])) return std::nullopt;
    return falls;
}

/// The fastest fall within `reach_mm` of the place.
double most_of(const Falls& falls, double reach_mm) {
    const int reach = static_cast<int>(reach_mm / kStep_mm);
    double most = 0;
    for (int i = -reach; i <= reach; ++i) most = std::fmax(most, falls[static_cast<std::size_t>(i + kSteps)]);
    return most;
}

double to_edge_mm(const Falls& falls, double least) {
    const auto at = [&](int i) { return falls[static_cast<std::size_t>(i + kSteps)]; };
    double nearest = kReach_mm;
    for (int i = -kSteps; i <= kSteps; ++i) {
        if (!(at(i) >= least)) continue;
        const bool top = (i == -kSteps || !(at(i - 1) > at(i))) && (i == kSteps || !(at(i + 1) > at(i)));
        if (top) nearest = std::min(nearest, std::abs(i) * kStep_mm);
    }
    return nearest;
}

}  // namespace

SurfaceFit fit_of(const TriangleMesh& surface, const Volume& volume) {
    const Sampler sampler(volume);
    const std::size_t count = surface.vertices_in_ct.size(), step = 1 + count / kAsked;
    SurfaceFit fit;
    for (const Vector3d& p : surface.vertices_in_ct) fit.share_inside += sampler.inside(p);
    fit.share_inside /= std::max<double>(1, static_cast<double>(count));
    std::vector<Falls> all;
    std::vector<double> most, here;
    for (std::size_t v = 0; v < count; v += step) {
        const Vector3d &p = surface.vertices_in_ct[v], &n = surface.normals_in_ct[v];
        const auto falls = falls_at(sampler, p, n);
        if (!falls) continue;
        all.push_back(*falls);
        most.push_back(most_of(*falls, kReach_mm));
        here.push_back(most_of(*falls, kOnEdge_mm));
        fit.share_darker += sampler.at(p - kAcrossEdge_mm * n) > sampler.at(p + kAcrossEdge_mm * n);
    }
    if (all.empty()) return fit;
    constexpr double kOfUsual = 0.4, kLeast_hu = 150, kLeast = 0.15;
    const double no_noise = volume.is_hu ? kLeast_hu : kLeast * median(std::move(most));
    const double least = std::max({kOfUsual * median(std::move(here)), no_noise, 1e-9});
    std::vector<double> off_mm;
    for (const Falls& falls : all) {
        off_mm.push_back(to_edge_mm(falls, least));
        fit.share_on_edge += off_mm.back() <= kOnEdge_mm;
    }
    fit.share_darker /= static_cast<double>(all.size());
    fit.share_on_edge /= static_cast<double>(all.size());
    fit.median_mm = median(std::move(off_mm));
    return fit;
}

SurfaceFit check_surface_fits(const TriangleMesh& surface, const Volume& volume, const std::filesystem::path& file) {
    const SurfaceFit fit = fit_of(surface, volume);
    if (fit.share_inside < kLeastInside)
        throw InputError(
            file, fmt::format("lies outside the volume with {:.0f} % of its points", 100 * (1 - fit.share_inside)),
            "Check that it was made on this CT, and its coordinate system.");
    if (volume.modality != "CT") return fit;
    if (fit.share_darker < kLeastDarker)
        throw InputError(
            file,
            fmt::format("does not lie on an edge of this CT: only at {:.0f} % of its points it is brighter under "
                        "the surface than over it",
                        100 * fit.share_darker),
            "Check that it was made on this CT, and its coordinate system.");
    if (fit.share_on_edge < kLeastOnEdge)
        throw InputError(
            file,
            fmt::format("does not lie on an edge of this CT: only {:.0f} % of its points are within {:.0f} mm of one, "
                        "half of them within {:.1f} mm",
                        100 * fit.share_on_edge, kOnEdge_mm, fit.median_mm),
            "Check that it was made on this CT, that it was not moved, turned or scaled since, and its coordinate "
            "system.");
    return fit;
}

std::string doubt_of(const SurfaceFit& fit, const std::filesystem::path& file) {
    if (fit.share_on_edge >= kUsuallyOnEdge) return {};
    return fmt::format(
        "{}: {:.0f} % of its points lie within {:.0f} mm of an edge of the volume, fewer than of a surface that was "
        "made on it: it may have been moved, turned, mirrored or smoothed since; look at it in the slices of the page",
        file.filename().string(), 100 * fit.share_on_edge, kOnEdge_mm);
}

}  // namespace planlight
