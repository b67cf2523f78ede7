#include "segmentation/level_map.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace planlight {
namespace {

using Eigen::Vector3d;

/// The eight nodes round a place and their weights.
struct Corners {
    std::array<std::size_t, 8> node{};
    std::array<float, 8> weight{};

    Corners(const LevelMap& map, const Vector3d& at_in_ct) {
        std::size_t low[3], high[3];
        float f[3];
        for (int a = 0; a < 3; ++a) {
            const int last = map.size[static_cast<std::size_t>(a)] - 1;
            const double at =
                std::clamp((at_in_ct[a] - map.first_in_ct[a]) / map.step_mm, 0.0, static_cast<double>(last));
            const int floor = std::min(static_cast<int>(at), std::max(0, last - 1));
            f[a] = static_cast<float>(at - floor);
            low[a] = static_cast<std::size_t>(floor);
            high[a] = static_cast<std::size_t>(std::min(floor + 1, last));
        }
        for (unsigned c = 0; c < 8; ++c) {
            node[c] =
                ((c & 4 ? high[2] : low[2]) * static_cast<std::size_t>(map.size[1]) + (c & 2 ? high[1] : low[1])) *
                    static_cast<std::size_t>(map.size[0]) +
                (c & 1 ? high[0] : low[0]);
            weight[c] = (c & 1 ? f[0] : 1 - f[0]) * (c & 2 ? f[1] : 1 - f[1]) * (c & 4 ? f[2] : 1 - f[2]);
        }
    }
    float of(const std::vector<float>& values) const {
        float sum = 0;
        for (std::size_t c = 0; c < 8; ++c) sum += weight[c] * values[node[c]];
        return sum;
    }
};

struct Levels {
    float air = 0, skin = 1;
};

Levels levels_at(const LevelMap& map, const Vector3d& at_in_ct) {
    const Corners corners(map, at_in_ct);
    return {corners.of(map.air), corners.of(map.skin)};
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

float value_at(const LevelMap& map, const std::vector<float>& of, const Vector3d& at_in_ct) {
    return Corners(map, at_in_ct).of(of);
}

double middle_threshold(const LevelMap& map) {
    if (map.empty()) return 0;
    std::vector<float> sorted = map.skin;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    return static_cast<double>(*middle);
}

}  // namespace planlight
