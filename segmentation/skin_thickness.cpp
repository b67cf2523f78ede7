#include "segmentation/skin_thickness.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <limits>
#include <optional>

#include "planning_io/volume/volume_sample.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

/// The first crossing of `threshold` on the way from `start`, in steps.
std::optional<double> first_crossing(const Volume& volume, const Vector3d& start, const Vector3d& step, int steps,
                                     double threshold) {
    double before = -INFINITY;
    for (int s = 0; s <= steps; ++s) {
        const auto value = value_at(volume, start + s * step);
        if (!value && s > 2) return std::nullopt;
        if (!value) continue;  // skin half a voxel beyond the last centres
        if (*value >= threshold) return std::isfinite(before) ? s - (*value - threshold) / (*value - before) : s;
        before = *value;
    }
    return std::nullopt;
}

}  // namespace

std::vector<float> skin_thickness(const Volume& volume, const TriangleMesh& skin, const ThicknessSettings& settings) {
    if (!volume.is_hu || volume.modality != "CT" || skin.normals_in_ct.size() != skin.vertices_in_ct.size()) return {};
    const Eigen::Affine3d voxel_from_ct = volume.ct_from_voxel.inverse();
    const double step_mm = 0.5 * volume.spacing_mm().minCoeff();
    const int steps = static_cast<int>(std::ceil(settings.longest_mm / step_mm));
    std::vector<float> thickness_mm(skin.vertices_in_ct.size(), std::numeric_limits<float>::quiet_NaN());
    tbb::parallel_for(std::size_t{0}, thickness_mm.size(), [&](std::size_t v) {
        if (!skin.flags.empty() && skin.flags[v] != kSkin) return;
        const Vector3d step = voxel_from_ct.linear() * (-step_mm * skin.normals_in_ct[v]);
        const auto crossing =
            first_crossing(volume, voxel_from_ct * skin.vertices_in_ct[v], step, steps, settings.bone_hu);
        if (crossing && *crossing * step_mm <= settings.longest_mm)
            thickness_mm[v] = static_cast<float>(*crossing * step_mm);
    });
    return thickness_mm;
}

}  // namespace planlight
