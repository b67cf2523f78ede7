#include "tests/segmentation/spoil_volume.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "planning_io/types/statistics.h"
#include "planning_io/volume/volume_sample.h"

namespace planlight::test {

void window_to_8_bits(Volume& volume, double low) {
    const double high = static_cast<double>(quantile(volume.values, 0.998)), from = low * high;
    for (float& v : volume.values)
        v = static_cast<float>(std::round(std::clamp((static_cast<double>(v) - from) / (high - from), 0.0, 1.0) * 255));
}

void blend_with_moved(Volume& volume, const Eigen::Vector3d& by_mm, double degrees, double share) {
    const Volume still = volume;
    const Eigen::Vector3d middle =
        still.ct_from_voxel * (0.5 * Eigen::Vector3d(still.size[0], still.size[1], still.size[2]));
    const Eigen::Affine3d back = Eigen::Translation3d(middle) *
                                 Eigen::AngleAxisd(-degrees * std::numbers::pi / 180, Eigen::Vector3d::UnitX()) *
                                 Eigen::Translation3d(-middle - by_mm);
    const Eigen::Affine3d from = still.ct_from_voxel.inverse() * back * still.ct_from_voxel;
    tbb::parallel_for(0, still.size[2], [&](int k) {
        for (int j = 0; j < still.size[1]; ++j)
            for (int i = 0; i < still.size[0]; ++i) {
                const double moved = value_at(still, from * Eigen::Vector3d(i, j, k)).value_or(0);
                float& value = volume.values[volume.index(i, j, k)];
                value = static_cast<float>((1 - share) * static_cast<double>(value) + share * moved);
            }
    });
}

void divide_by_another(Volume& volume) {
    const double tissue = static_cast<double>(quantile(volume.values, 0.95));
    std::mt19937 random(5);
    std::normal_distribution<double> noise(0, 0.02);
    for (float& v : volume.values) {
        const double signal = static_cast<double>(v) / tissue, one = signal * signal + noise(random),
                     other = signal * (1.2 - signal) + noise(random);
        v = static_cast<float>(500 + 1000 * one * other / std::max(one * one + other * other, 1e-12));
    }
}

}  // namespace planlight::test
