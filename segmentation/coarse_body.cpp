#include "segmentation/coarse_body.h"

namespace planlight {

using Eigen::Vector3d;

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
    return coarse;
}

}  // namespace planlight
