#include "segmentation/head_outline.h"

#include <algorithm>
#include <cmath>

#include "planning_io/types/statistics.h"
#include "segmentation/detach_objects.h"
#include "segmentation/distance_transform.h"
#include "segmentation/learn_levels.h"

namespace planlight {
namespace {

constexpr int kRounds = 3;

Mask outside_of(const HeadSurvey& survey, const Mask& solid) {
    Mask state = solid;
    std::vector<std::size_t> seeds;
    for (std::size_t v = 0; v < state.size(); ++v) {
        if (!survey.measured[v]) state[v] = 1;
        if (survey.rim[v] && !state[v]) seeds.push_back(v);
    }
    flood(state, survey.grid, std::move(seeds), 0, 2);
    for (auto& v : state) v = v == 2;
    return state;
}

/// Air past lids over narrow openings; it takes back the creases within the seal's radius of it.
Mask sealed_outside(const HeadSurvey& survey, const Mask& dense, double seal_radius_mm) {
    Mask outside = outside_of(survey, close(dense, survey.grid, seal_radius_mm));
    const Mask near = dilate(outside, survey.grid, 0.7 * seal_radius_mm);
    std::vector<std::size_t> seeds;
    for (std::size_t v = 0; v < outside.size(); ++v) {
        if (outside[v]) seeds.push_back(v);
        outside[v] = outside[v] || (survey.measured[v] && !dense[v] && near[v]) ? 3 : 0;
    }
    flood(outside, survey.grid, std::move(seeds), 3, 1);
    for (auto& v : outside) v = v == 1;
    return outside;
}

/// The levels at every voxel of the survey; below `sure` a value is air and nothing else.
struct Field {
    std::vector<float> air, sure, skin;
};

Field field_of(const HeadSurvey& survey, const LevelMap& map, const std::vector<float>& sure) {
    Volume places;  // the map's own interpolation, at the survey's voxels: (0 - air) / (skin - air) and (1 - air) /
                    // (skin - air)
    places.size = survey.grid.size;
    places.ct_from_voxel.linear() = Eigen::Matrix3d::Identity() * survey.step_mm();
    places.ct_from_voxel.translation() = survey.first_in_ct;
    places.values.assign(survey.grid.count(), 0);
    const Volume zero = in_levels(places, map);
    places.values.assign(survey.grid.count(), 1);
    const Volume one = in_levels(std::move(places), map);
    Field field;
    field.air.resize(zero.values.size());
    field.skin.resize(zero.values.size());
    for (std::size_t v = 0; v < zero.values.size(); ++v) {
        const float step = 1 / (one.values[v] - zero.values[v]);
        field.air[v] = -zero.values[v] * step;
        field.skin[v] = field.air[v] + step;
    }
    LevelMap of_sure = map;  // the same interpolation, of what is surely air
    of_sure.skin = sure;
    places.values.assign(survey.grid.count(), 1);
    const Volume sure_one = in_levels(std::move(places), of_sure);
    field.sure.resize(field.air.size());
    for (std::size_t v = 0; v < field.air.size(); ++v)
        field.sure[v] = std::min(field.skin[v], field.air[v] + (1 - field.air[v]) / sure_one.values[v]);
    return field;
}

constexpr double kHalo_mm =
    8;  // how far from sure air something dim may still be the blur, halo or ghost before the skin

/// What air reaches: through what is surely air, and from there through what is dim, but not deep: dim muscle at the
/// end of a coil is no way in.
Mask reached_by_air(const HeadSurvey& survey, const Mask& dense, const Mask& not_air, double seal_radius_mm) {
    Mask outside = sealed_outside(survey, dense, seal_radius_mm);
    const Mask sure = sealed_outside(survey, not_air, seal_radius_mm);
    const auto count = [](const Mask& mask) { return std::count(mask.begin(), mask.end(), 1); };
    if (2 * count(sure) < count(outside)) return outside;  // noise or ghosts all over: the threshold alone
    const Mask near = dilate(sure, survey.grid, kHalo_mm);
    for (std::size_t v = 0; v < outside.size(); ++v) outside[v] = outside[v] && near[v];
    return outside;
}

/// The head at `factor` times the threshold above air.
Mask head_at(const HeadSurvey& survey, const std::vector<float>& values, const Field& field, double factor,
             const OutlineSettings& settings, Mask* gone = nullptr) {
    Mask dense(values.size()), not_air(values.size());
    std::vector<float> level(values.size());
    for (std::size_t v = 0; v < dense.size(); ++v) {
        level[v] = (values[v] - field.air[v]) / (static_cast<float>(factor) * (field.skin[v] - field.air[v]));
        dense[v] = survey.measured[v] && level[v] >= 1;
        not_air[v] = survey.measured[v] && (dense[v] || values[v] >= field.sure[v]);
    }
    Mask body = reached_by_air(survey, dense, not_air, settings.seal_radius_mm);
    for (std::size_t v = 0; v < body.size(); ++v) body[v] = survey.measured[v] && !body[v];
    DetachedBody detached = detach_objects(body, level, 1, survey.grid, settings.detach_radius_mm, Contact::with_core);
    if (detached.body.empty()) return Mask(body.size(), 0);
    for (std::size_t v = 0; v < body.size(); ++v) detached.body[v] = detached.body[v] && survey.measured[v];
    Mask head = largest_piece(std::move(detached.body), survey.grid).mask;
    if (gone != nullptr) {
        *gone = std::move(dense);
        for (std::size_t v = 0; v < head.size(); ++v) (*gone)[v] = (*gone)[v] && !head[v];
    }
    return head;
}

double ml_of(const Mask& mask, const VoxelGrid& grid) {
    std::size_t voxels = 0;
    for (const auto v : mask) voxels += v;
    return static_cast<double>(voxels) * grid.voxel_ml();
}

/// Share of the outline of `outer` that lies further than `apart_mm` from the outline of `inner`.
double share_apart(const Mask& outer, const Mask& inner, const HeadSurvey& survey, double apart_mm) {
    const auto from_inner = distance_from(inner, 1, survey.grid, 20);
    std::size_t outline = 0, apart = 0;
    for (std::size_t v = 0; v < outer.size(); ++v) {
        if (!outer[v]) continue;
        bool edge = false;
        for_face_neighbours(survey.grid, v, [&](std::size_t n) { edge = edge || (!outer[n] && survey.measured[n]); });
        outline += edge;
        apart += edge && static_cast<double>(from_inner[v]) > apart_mm;
    }
    return outline > 0 ? static_cast<double>(apart) / static_cast<double>(outline) : 1;
}

}  // namespace

HeadOutline outline_of(const HeadSurvey& survey, const OutlineSettings& settings) {
    HeadOutline outline;
    const std::vector<float> values = smoothed(survey, survey.values);
    std::vector<float> measured;
    for (std::size_t v = 0; v < values.size(); ++v)
        if (survey.measured[v]) measured.push_back(values[v]);
    outline.head.assign(values.size(), 0);
    if (measured.empty()) return outline;
    const double low = static_cast<double>(quantile(measured, 0.001));
    const double first = settings.threshold != 0 ? settings.threshold : first_threshold(measured);
    if (!(first > low)) return outline;
    Field field;
    field.air.assign(values.size(), static_cast<float>(low));
    field.skin.assign(values.size(), static_cast<float>(first));
    field.sure = field.skin;
    for (int round = 0; round < kRounds; ++round) {
        outline.head = head_at(survey, values, field, 1, settings);
        if (std::find(outline.head.begin(), outline.head.end(), 1) == outline.head.end()) return outline;
        const std::vector<float> sure = learn_levels(survey, values, settings, outline);
        field = field_of(survey, outline.levels, sure);
    }
    outline.head = head_at(survey, values, field, 1, settings, &outline.gone);
    outline.volume_ml = ml_of(outline.head, survey.grid);
    const Mask lower = head_at(survey, values, field, 0.7, settings),
               higher = head_at(survey, values, field, 1.5, settings);
    outline.lower_ml = ml_of(lower, survey.grid);
    outline.higher_ml = ml_of(higher, survey.grid);
    outline.unsure_share = share_apart(lower, higher, survey, 3);
    return outline;
}

}  // namespace planlight
