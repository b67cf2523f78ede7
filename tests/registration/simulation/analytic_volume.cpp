#include "tests/registration/simulation/analytic_volume.h"

#include <algorithm>

#include "tests/support/analytic_head.h"

namespace planlight::test {

Volume volume_of_analytic_head(bool plates) {
    constexpr double kVoxel_mm = 2;
    Volume volume;
    volume.size = {120, 125, 125};
    volume.ct_from_voxel = Eigen::Translation3d(-119, -126, -120) * Eigen::Scaling(kVoxel_mm);
    volume.is_hu = true;
    volume.modality = "CT";
    volume.source = "analytic head";
    volume.values.resize(volume.index(0, 0, volume.size[2]));
    for (int k = 0; k < volume.size[2]; ++k)
        for (int j = 0; j < volume.size[1]; ++j)
            for (int i = 0; i < volume.size[0]; ++i) {
                const Eigen::Vector3d p = volume.ct_from_voxel * Eigen::Vector3d(i, j, k);
                double hu = std::clamp(-300 - 150 * analytic_head_distance(p), -1000.0, 60.0);
                if (plates && std::abs(std::abs(p.x()) - 114) < 3) hu = 400;
                volume.values[volume.index(i, j, k)] = static_cast<float>(hu);
            }
    return volume;
}

}  // namespace planlight::test
