#include <algorithm>
#include <cmath>
#include <vector>

#include "planning_io/types/statistics.h"
#include "planning_io/volume/volume_sample.h"
#include "segmentation/segment_skin.h"

namespace planlight {
namespace {

constexpr double kAside_mm = 0.5;  // from the skin, for its slope: within the blur of the edge

/// Of a voxel within the body, along the first axis.
double noise_of(const Volume& volume, const SkinMask& mask) {
    std::vector<double> seconds;
    for (std::size_t v = 1; v + 1 < volume.values.size(); v += 5)
        if (mask.body[v - 1] && mask.body[v] && mask.body[v + 1])
            seconds.push_back(
                std::abs(static_cast<double>(volume.values[v - 1] - 2 * volume.values[v] + volume.values[v + 1])));
    return 1.4826 * median(std::move(seconds)) / std::sqrt(6.0);  // 1 + 4 + 1 times the variance of one
}

}  // namespace

double skin_edge_sigma_mm(const Volume& volume, const SkinMask& mask, const TriangleMesh& skin) {
    const Eigen::Affine3d voxel_from_ct = volume.ct_from_voxel.inverse();
    std::vector<double> slopes;
    for (std::size_t v = 0; v < skin.vertices_in_ct.size(); ++v) {
        if (skin.flags[v] != kSkin) continue;
        const Eigen::Vector3d at = voxel_from_ct * skin.vertices_in_ct[v],
                              aside = voxel_from_ct.linear() * (kAside_mm * skin.normals_in_ct[v]);
        const auto inside = value_at(volume, at - aside), outside = value_at(volume, at + aside);
        if (inside && outside && std::isfinite(*inside - *outside))
            slopes.push_back((*inside - *outside) / (2 * kAside_mm));
    }
    const double slope = median(std::move(slopes));
    return slope > 0 ? noise_of(volume, mask) / slope : 0;
}

}  // namespace planlight
