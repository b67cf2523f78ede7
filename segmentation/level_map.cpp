#include "segmentation/level_map.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace planlight {
namespace {

using Eigen::Vector3d;

struct Levels {
    float air = 0, skin = 1;
};

Levels levels_at(const LevelMap& map, const Vector3d& at_in_ct) {
    std::size_t low[3], high[3];
    float f[3];
    for (int a = 0; a < 3; ++a) {
        const int last = map.size[static_cast<std::size_t>(a)] - 1;
        const double at = std::clamp((at_in_ct[a] - map.first_in_ct[a]) / map.step_mm, 0.0, static_cast<double>(last));
        const int floor = std::min(static_cast<int>(at), std::max(0, last - 1));
        f[a] = static_cast<float>(at - floor);
        low[a] = static_cast<std::size_t>(floor);
        high[a] = static_cast<std::size_t>(std::min(floor + 1, last));
    }
    Levels sum{0, 0};
    for (int corner = 0; corner < 8; ++corner) {
        const std::size_t node = (((corner >> 2) & 1 ? high[2] : low[2]) * static_cast<std::size_t>(map.size[1]) +
                                  ((corner >> 1) & 1 ? high[1] : low[1])) * static_cast<std::size_t>(map.size[0]) +
                                 (corner & 1 ? high[0] : low[0]);
        float weight = 1;
        for (int a = 0; a < 3; ++a) weight *= (corner >> a) & 1 ? f[a] : 1 - f[a];
        sum.air += weight * map.air[node];
        sum.skin += weight * map.skin[node];
    }
    return sum;
}

}  // namespace

Volume in_levels(Volume volume, const LevelMap& map) {
    if (map.empty()) return volume;
    tbb::parallel_for(0, volume.size[2], [&](int k) {
        constexpr int kEvery = 4;  // voxels along a row between which the map is linear enough
        for (int j = 0; j < volume.size[1]; ++j)
            for (int from = 0; from < volume.size[0]; from += kEvery) {
                const Levels a = levels_at(map, volume.ct_from_voxel * Vector3d(from, j, k)),
                             b = levels_at(map, volume.ct_from_voxel * Vector3d(from + kEvery, j, k));
                for (int i = from; i < std::min(from + kEvery, volume.size[0]); ++i) {
                    const float f = static_cast<float>(i - from) / kEvery, air = a.air + f * (b.air - a.air),
                                skin = a.skin + f * (b.skin - a.skin);
                    float& value = volume.values[volume.index(i, j, k)];
                    value = (value - air) / (skin - air);
                }
            }
    });
    return volume;
}

double middle_threshold(const LevelMap& map) {
    if (map.empty()) return 0;
    std::vector<float> sorted = map.skin;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    return static_cast<double>(*middle);
}

}  // namespace planlight
