#include "segmentation/blank_places.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

#include "segmentation/voxel_morphology.h"

namespace planlight {
namespace {

constexpr double kLeastShare = 0.01;
constexpr double kNearBlank_voxels = 2;  // where a correction laid out anew, the end is blurred

Mask blank_places(const Volume& volume, float blank) {
    const VoxelGrid grid{volume.size, {1, 1, 1}};
    Mask places(volume.values.size());
    tbb::parallel_for(0, volume.size[2], [&](int k) {
        const std::size_t begin = static_cast<std::size_t>(k) * grid.slab();
        for (std::size_t v = begin; v < begin + grid.slab(); ++v) {
            if (volume.values[v] != blank) continue;
            bool all = true;
            for_face_neighbours(grid, v, [&](std::size_t n) { all = all && volume.values[n] == blank; });
            places[v] = all;
        }
    });
    return dilate(places, grid, 1);  // their own rim is blank too
}

}  // namespace

std::optional<float> blank_value(const Volume& volume) {
    float least = std::numeric_limits<float>::infinity();
    for (const float v : volume.values)
        if (v < least) least = v;
    const auto at_least = std::count(volume.values.begin(), volume.values.end(), least);
    if (static_cast<double>(at_least) < kLeastShare * static_cast<double>(volume.values.size())) return std::nullopt;
    const Mask places = blank_places(volume, least);
    const auto blank = std::count(places.begin(), places.end(), 1);
    if (static_cast<double>(blank) < kLeastShare * static_cast<double>(volume.values.size())) return std::nullopt;
    return least;
}

void forget_blank(Volume& volume, float blank) {
    const Mask places = blank_places(volume, blank);
    for (std::size_t v = 0; v < places.size(); ++v)
        if (places[v] && volume.values[v] == blank) volume.values[v] = std::numeric_limits<float>::quiet_NaN();
}

void flag_ends_at_blank(TriangleMesh& mesh, const Volume& volume, float blank) {
    const Mask near = dilate(blank_places(volume, blank), {volume.size, {1, 1, 1}}, kNearBlank_voxels);
    const Eigen::Affine3d voxel_from_ct = volume.ct_from_voxel.inverse();
    tbb::parallel_for(std::size_t{0}, mesh.vertices_in_ct.size(), [&](std::size_t v) {
        Eigen::Vector3i at = (voxel_from_ct * mesh.vertices_in_ct[v]).array().round().cast<int>();
        for (int axis = 0; axis < 3; ++axis)
            at[axis] = std::clamp(at[axis], 0, volume.size[static_cast<std::size_t>(axis)] - 1);
        if (mesh.flags[v] == kSkin && near[volume.index(at.x(), at.y(), at.z())]) mesh.flags[v] = kCutPlane;
    });
}

}  // namespace planlight
