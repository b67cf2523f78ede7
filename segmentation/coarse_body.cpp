#include "segmentation/coarse_body.h"

#include <algorithm>

#include "segmentation/distance_transform.h"

namespace planlight {

using Eigen::Vector3d;

namespace {

constexpr double kBeyond_mm = 60;

/// Where values were blanked within the volume the head goes on unseen: what lies nearer to such an end than to skin
/// was not measured.
void forget_beyond_ends(const Volume& volume, const TriangleMesh& skin, std::uint8_t beyond, CoarseBody& coarse) {
    HeadSurvey& places = coarse.places;
    const Eigen::Affine3d voxel_from_ct = volume.ct_from_voxel.inverse();
    const auto is_within = [&](const Vector3d& p_in_ct) {
        const Vector3d at = voxel_from_ct * p_in_ct;
        for (int a = 0; a < 3; ++a)
            if (at[a] < 0.5 || at[a] > volume.size[static_cast<std::size_t>(a)] - 1.5) return false;
        return true;
    };
    Mask ends(places.grid.count(), 0), real = ends;
    bool any = false;
    for (std::size_t v = 0; v < skin.flags.size(); ++v) {
        const Vector3d& p = skin.vertices_in_ct[v];
        const bool end = skin.flags[v] == kCutPlane;
        if (end && !is_within(p)) continue;
        const Eigen::Vector3i at = ((p - places.first_in_ct) / places.step_mm()).array().round().cast<int>();
        (end ? ends : real)[places.index(at.x(), at.y(), at.z())] = 1;
        any = any || end;
    }
    if (!any) return;
    const auto from_end = distance_from(ends, 1, places.grid, kBeyond_mm),
               from_real = distance_from(real, 1, places.grid, kBeyond_mm);
    for (std::size_t v = 0; v < coarse.body.size(); ++v)
        if (places.measured[v] && !coarse.body[v] && from_end[v] < from_real[v])
            places.measured[v] = 0, coarse.body[v] = beyond;
}

}  // namespace

CoarseBody coarse_body(const Volume& volume, const SkinMask& mask, const TriangleMesh& skin, double step_mm,
                       std::uint8_t beyond) {
    CoarseBody coarse;
    coarse.low_in_ct = coarse.high_in_ct = skin.vertices_in_ct.front();
    for (const auto& p : skin.vertices_in_ct) {
        coarse.low_in_ct = coarse.low_in_ct.cwiseMin(p);
        coarse.high_in_ct = coarse.high_in_ct.cwiseMax(p);
    }
    VoxelGrid& grid = coarse.places.grid;
    grid.spacing_mm = Vector3d::Constant(step_mm);
    coarse.places.first_in_ct = coarse.low_in_ct - Vector3d::Constant(step_mm);
    for (int a = 0; a < 3; ++a)
        grid.size[static_cast<std::size_t>(a)] =
            static_cast<int>((coarse.high_in_ct - coarse.low_in_ct)[a] / step_mm) + 3;
    coarse.body.assign(grid.count(), beyond);
    coarse.places.measured.assign(grid.count(), 0);
    const Eigen::Affine3d voxel_from_ct = volume.ct_from_voxel.inverse();
    for (std::size_t v = 0; v < coarse.body.size(); ++v) {
        const Eigen::Vector3i at = (voxel_from_ct * coarse.places.place_of(v)).array().round().cast<int>();
        bool inside = true;
        for (int a = 0; a < 3; ++a) inside = inside && at[a] >= 0 && at[a] < volume.size[static_cast<std::size_t>(a)];
        if (!inside) continue;
        coarse.places.measured[v] = 1;
        coarse.body[v] = mask.body[volume.index(at.x(), at.y(), at.z())];
    }
    forget_beyond_ends(volume, skin, beyond, coarse);
    return coarse;
}

}  // namespace planlight
