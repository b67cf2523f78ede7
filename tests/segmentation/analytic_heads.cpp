#include "tests/segmentation/analytic_heads.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace planlight::test {

using Eigen::Vector3d;

Volume mr_of(const std::function<double(const Vector3d&)>& signal, const Vector3d& half_mm, double noise,
             double turn_degrees) {
    Volume volume;
    volume.modality = "MR";
    volume.ct_from_voxel = Eigen::AngleAxisd(turn_degrees * std::numbers::pi / 180, Vector3d::UnitZ()) *
                           Eigen::Translation3d(-half_mm) * Eigen::Scaling(3.0);
    for (int a = 0; a < 3; ++a) volume.size[static_cast<std::size_t>(a)] = static_cast<int>(2 * half_mm[a] / 3) + 1;
    std::mt19937 random(3);
    std::normal_distribution<double> normal(0, noise);
    for (int k = 0; k < volume.size[2]; ++k)
        for (int j = 0; j < volume.size[1]; ++j)
            for (int i = 0; i < volume.size[0]; ++i)
                volume.values.push_back(static_cast<float>(
                    std::hypot(signal(volume.ct_from_voxel * Vector3d(i, j, k)) + normal(random), normal(random))));
    return volume;
}

double depth_in_head(const Vector3d& p, bool nose) {
    const double egg = 80 * (1 - Vector3d(p.x() / 75, p.y() / 92, p.z() / 85).norm());
    return nose ? std::max(egg, 12 - (p - Vector3d(0, -100, -30)).norm()) : egg;
}

double layered(double depth) {
    return depth < 0 ? 0 : depth < 6 ? 900 : depth < 13 ? 40 : 500;
}

Volume head_with(const std::function<bool(const Vector3d& p, double depth)>& is_there, double turn_degrees) {
    return mr_of(
        [&](const Vector3d& p) {
            const double depth = depth_in_head(p);
            return depth < 0 && is_there(p, depth) ? 900 : layered(depth);
        },
        {125, 145, 115}, 12, turn_degrees);
}

Volume ct_of(const std::function<double(const Vector3d& p, double depth)>& on_it, const Vector3d& half_mm) {
    Volume ct = mr_of(
        [&](const Vector3d& p) {
            const double depth = depth_in_head(p);
            return 1000 + (depth < 0 ? on_it(p, depth) : depth < 6 ? 40 : depth < 13 ? 900 : 35);
        },
        half_mm);
    ct.modality = "CT";
    ct.is_hu = true;
    for (float& value : ct.values) value -= 1000;
    return ct;
}

Judged judged(const Volume& volume) {
    const SkinMask mask = segment_skin(volume);
    Judged result{judge_skin(volume, mask, triangulate_skin(volume, mask)), false};
    result.refused = !result.skin.refusals.empty();
    return result;
}

bool doubts(const SkinJudgement& skin, const std::string& word) {
    return std::any_of(skin.doubts.begin(), skin.doubts.end(),
                       [&](const SkinDoubt& d) { return d.finding.find(word) != std::string::npos; });
}

}  // namespace planlight::test
