#include "segmentation/beside_head.h"

#include <algorithm>
#include <cmath>

#include "segmentation/distance_transform.h"
#include "segmentation/head_survey.h"
#include "segmentation/outside_air.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr double kGrid_mm = 4, kMost_mm = 60;

/// Of the voxel of the volume that is nearest to a place within it.
bool is_body(const Volume& volume, const SkinMask& mask, const Vector3d& voxel) {
    std::array<int, 3> at{};
    for (std::size_t a = 0; a < 3; ++a)
        at[a] = std::clamp(static_cast<int>(std::lround(voxel[static_cast<Eigen::Index>(a)])), 0, volume.size[a] - 1);
    return mask.body[volume.index(at[0], at[1], at[2])] != 0;
}

}  // namespace

double ball_beside_head_mm(const Volume& volume, const SkinMask& mask) {
    SurveySettings settings;
    settings.step_mm = kGrid_mm;
    const HeadSurvey survey = survey_of(volume, settings);
    const Eigen::Affine3d voxel_from_ct = volume.ct_from_voxel.inverse();
    Mask beside(survey.values.size(), 0);
    for (std::size_t v = 0; v < beside.size(); ++v) {
        if (!survey.measured[v]) continue;
        const Vector3d at = survey.place_of(v);
        const double skin = mask.levels.empty() ? mask.threshold : value_at(mask.levels, mask.levels.skin, at);
        beside[v] = static_cast<double>(survey.values[v]) >= skin && !is_body(volume, mask, voxel_from_ct * at);
    }
    beside = largest_piece(std::move(beside), survey.grid).mask;
    if (beside.empty()) return 0;
    Mask air = outside_air(beside, survey.grid);
    const std::vector<float> depth_mm = distance_from(air, 1, survey.grid, kMost_mm);
    return static_cast<double>(*std::max_element(depth_mm.begin(), depth_mm.end()));
}

}  // namespace planlight
