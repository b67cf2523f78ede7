#include "registration/matching/skin_patches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "planning_io/types/statistics.h"
#include "planning_io/types/triangle_mesh.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

/// How another threshold moves skin that faces along `normal`: by the width of its edge in the CT, which is that of the
/// voxels and differs between the scanner's axes (slices are thicker than pixels are wide). Beside the offset of the
/// whole, a part that goes with x^2 and one that goes with z^2; they look like a shift of a head seen from one side.
Vector3d offset_basis(const Vector3d& normal) {
    return {1, normal.x() * normal.x() - 1. / 3, normal.z() * normal.z() - 1. / 3};
}

/// The mean of the points that lie near their median distance: strays do not move it. All that the distance depends on
/// is averaged over the same points, so that a patch on bent skin is as true as its points.
SkinPatch mean_of(const std::vector<const SkinPatch*>& points) {
    constexpr double kNear_mm = 0.3, kSpreads = 4;
    std::vector<double> distances, off;
    for (const SkinPatch* p : points) distances.push_back(p->distance_mm);
    const double middle = median(distances);
    for (const double d : distances) off.push_back(std::abs(d - middle));
    const double near_mm = std::max(kNear_mm, kSpreads * median(std::move(off)));
    SkinPatch mean;
    double count = 0;
    for (const SkinPatch* p : points) {
        if (std::abs(p->distance_mm - middle) > near_mm) continue;
        ++count;
        mean.x_in_ct += p->x_in_ct;
        mean.normal += p->normal;
        mean.distance_mm += p->distance_mm;
        mean.turned += p->turned;
        mean.offsets += p->offsets;
        mean.thickness_mm += p->thickness_mm;
        mean.known_thickness += p->known_thickness;
    }
    mean.x_in_ct /= count;
    mean.normal /= count;
    mean.distance_mm /= count;
    mean.turned /= count;
    mean.offsets /= count;
    if (mean.known_thickness > 0) mean.thickness_mm /= mean.known_thickness;
    return mean;
}

}  // namespace

std::vector<SkinPatch> points_on_skin(const PointCloud& cloud, const SkinLut& lut, const RigidTransform& ct_from_rig) {
    constexpr double kFar_mm = 6;
    std::vector<SkinPatch> points;
    const std::size_t stride = std::max<std::size_t>(1, cloud.size() / 20000);
    for (std::size_t i = 0; i < cloud.size(); i += stride) {
        if (!cloud.points_in_rig[i].allFinite()) continue;
        SkinPatch p;
        p.x_in_ct = ct_from_rig * cloud.points_in_rig[i];
        const SkinPoint* s = lut.nearest_skin(p.x_in_ct);
        if (!s || s->flags != kSkin) continue;
        p.normal = s->normal_in_ct.cast<double>();
        p.distance_mm = (p.x_in_ct - s->position_in_ct.cast<double>()).dot(p.normal);
        if (!(std::abs(p.distance_mm) < kFar_mm)) continue;
        p.turned = p.x_in_ct.cross(p.normal);
        p.offsets = offset_basis(p.normal);
        if (std::isfinite(s->thickness_mm)) p.thickness_mm = s->thickness_mm, p.known_thickness = 1;
        points.push_back(p);
    }
    return points;
}

std::vector<SkinPatch> patches_of(const PointCloud& cloud, const SkinLut& lut, const RigidTransform& ct_from_rig,
                                  int count) {
    constexpr std::size_t kFewest = 4;                            // points of a patch
    constexpr double kMost = 0.7, kWider = 1.5, kWidest_mm = 14;  // of the points: a thin scan takes larger patches
    const std::vector<SkinPatch> points = points_on_skin(cloud, lut, ct_from_rig);
    std::size_t held = 0;  // points of the patches
    const auto gathered = [&](double cell_mm) {
        held = 0;
        std::map<std::array<int, 3>, std::vector<const SkinPatch*>> cells;
        for (const SkinPatch& p : points) {
            const Eigen::Vector3i cell = (p.x_in_ct / cell_mm).array().floor().cast<int>();
            cells[{cell.x(), cell.y(), cell.z()}].push_back(&p);
        }
        std::vector<SkinPatch> patches;
        for (const auto& [cell, own] : cells) {
            if (own.size() < kFewest) continue;
            held += own.size();
            patches.push_back(mean_of(own));
        }
        return patches;
    };
    double cell_mm = 6;
    std::vector<SkinPatch> patches = gathered(cell_mm);
    while (static_cast<double>(held) < kMost * static_cast<double>(points.size()) && kWider * cell_mm <= kWidest_mm) {
        cell_mm *= kWider;
        patches = gathered(cell_mm);
    }
    for (int i = 0; i < 12 && static_cast<int>(patches.size()) > count; ++i) {
        cell_mm *= std::clamp(std::sqrt(static_cast<double>(patches.size()) / count), 1.05, 3.0);
        patches = gathered(cell_mm);
    }
    return patches;
}

}  // namespace planlight
