#include "segmentation/head_outline.h"

#include <algorithm>
#include <cmath>

#include "planning_io/types/statistics.h"
#include "segmentation/detach_objects.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr double kBlock_mm = 20;  // of the level map
constexpr double kAirFrom_mm = 6, kAirTo_mm = 24;
constexpr double kShell_mm = 6;  // under the outline, for the tissue near by
constexpr std::size_t kLeastSamples = 60;
constexpr int kRounds = 3;

struct Spread {
    double middle = 0, sigma = 0;
};

Spread spread_of(std::vector<float> values) {
    Spread s{static_cast<double>(median(values)), 0};
    for (float& v : values) v = std::abs(v - static_cast<float>(s.middle));
    s.sigma = 1.4826 * static_cast<double>(median(std::move(values)));
    return s;
}

/// Where the two classes part, on the root of the values above the least (noise and tissue differ by factors, not by
/// steps).
double first_threshold(const std::vector<float>& measured) {
    const double low = static_cast<double>(quantile(measured, 0.001)),
                 high = static_cast<double>(quantile(measured, 0.995));
    if (!(high > low)) return high;
    constexpr int kBins = 256;
    std::vector<double> bins(kBins, 0);
    for (const float v : measured) {
        const double share = std::clamp((static_cast<double>(v) - low) / (high - low), 0.0, 1.0);
        bins[static_cast<std::size_t>(std::min(std::sqrt(share) * kBins, kBins - 1.0))] += 1;
    }
    double all = 0, moment = 0, below = 0, below_moment = 0, best = -1;
    int level = 0;
    for (int b = 0; b < kBins; ++b)
        all += bins[static_cast<std::size_t>(b)], moment += b * bins[static_cast<std::size_t>(b)];
    for (int b = 0; b + 1 < kBins; ++b) {
        below += bins[static_cast<std::size_t>(b)];
        below_moment += b * bins[static_cast<std::size_t>(b)];
        if (below <= 0 || below >= all) continue;
        const double apart = below_moment / below - (moment - below_moment) / (all - below);
        if (const double between = below * (all - below) * apart * apart; between > best) best = between, level = b;
    }
    return low + (high - low) * std::pow((level + 1.0) / kBins, 2);
}

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

LevelMap map_over(const HeadSurvey& survey) {
    LevelMap map;
    map.step_mm = kBlock_mm;
    for (int a = 0; a < 3; ++a) {
        const double length = survey.step_mm() * survey.grid.size[static_cast<std::size_t>(a)];
        map.size[static_cast<std::size_t>(a)] = std::max(2, static_cast<int>(std::ceil(length / kBlock_mm)) + 1);
    }
    map.first_in_ct = survey.first_in_ct;
    const std::size_t nodes = static_cast<std::size_t>(map.size[0]) * static_cast<std::size_t>(map.size[1]) *
                              static_cast<std::size_t>(map.size[2]);
    map.air.assign(nodes, 0);
    map.skin.assign(nodes, 1);
    return map;
}

std::size_t node_of(const LevelMap& map, const HeadSurvey& survey, std::size_t voxel) {
    const Vector3d at = (survey.place_of(voxel) - map.first_in_ct) / map.step_mm;
    std::array<std::size_t, 3> node{};
    for (int a = 0; a < 3; ++a)
        node[static_cast<std::size_t>(a)] = static_cast<std::size_t>(
            std::clamp<long>(std::lround(at[a]), 0, map.size[static_cast<std::size_t>(a)] - 1));
    return (node[2] * static_cast<std::size_t>(map.size[1]) + node[1]) * static_cast<std::size_t>(map.size[0]) +
           node[0];
}

/// Fills nodes that are not a number with the mean of their neighbours that are, until none is left.
void spread_known(std::vector<float>& nodes, const std::array<int, 3>& size, float otherwise) {
    const VoxelGrid grid{size, {1, 1, 1}};
    for (bool more = true; more;) {
        more = false;
        bool found = false;
        std::vector<float> next = nodes;
        for (std::size_t n = 0; n < nodes.size(); ++n) {
            if (!std::isnan(nodes[n])) continue;
            more = true;
            float sum = 0, count = 0;
            for_face_neighbours(grid, n, [&](std::size_t m) {
                if (!std::isnan(nodes[m])) sum += nodes[m], count += 1;
            });
            if (count > 0) next[n] = sum / count, found = true;
        }
        nodes = std::move(next);
        if (more && !found) {
            std::fill(nodes.begin(), nodes.end(), otherwise);
            return;
        }
    }
}

void smooth_nodes(std::vector<float>& nodes, const std::array<int, 3>& size) {
    const VoxelGrid grid{size, {1, 1, 1}};
    std::vector<float> next = nodes;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        float sum = 2 * nodes[n], count = 2;
        for_face_neighbours(grid, n, [&](std::size_t m) { sum += nodes[m], count += 1; });
        next[n] = sum / count;
    }
    nodes = std::move(next);
}

/// Air and threshold from what lies round and in the head found so far.
/// Returns the map's values below which all is air.
std::vector<float> learn(const HeadSurvey& survey, const std::vector<float>& values, const OutlineSettings& settings,
                         HeadOutline& outline) {
    const Mask& head = outline.head;
    const auto away = distance_from(head, 1, survey.grid, kAirTo_mm + 10),
               depth = distance_from(head, 0, survey.grid, kShell_mm + 10);
    LevelMap& map = outline.levels = map_over(survey);
    std::vector<std::vector<float>> air(map.air.size()), shell(map.air.size());
    std::vector<float> all_air, all_tissue;
    for (std::size_t v = 0; v < values.size(); ++v) {
        if (!survey.measured[v]) continue;
        if (!head[v] && away[v] >= kAirFrom_mm && away[v] <= kAirTo_mm) {
            all_air.push_back(values[v]);
            air[node_of(map, survey, v)].push_back(values[v]);
        }
        if (head[v] && depth[v] <= kShell_mm) shell[node_of(map, survey, v)].push_back(values[v]);
        if (head[v]) all_tissue.push_back(values[v]);
    }
    const Spread round_head = spread_of(all_air);
    outline.air = round_head.middle;
    outline.air_sigma = round_head.sigma;
    outline.tissue = static_cast<double>(quantile(std::move(all_tissue), 0.6));
    const double contrast = outline.tissue - outline.air;
    if (!(contrast > 0)) return map.skin;
    std::vector<float> noise(map.air.size(), NAN), tissue(map.air.size(), NAN);
    for (std::size_t n = 0; n < map.air.size(); ++n) {
        map.air[n] = NAN;
        if (air[n].size() >= kLeastSamples) {
            const Spread here = spread_of(std::move(air[n]));
            // Where the head was missed so far, its tissue would pass for air.
            const double least = outline.air,
                         most = std::max(outline.air + 3 * outline.air_sigma, outline.air + 0.15 * contrast);
            map.air[n] = static_cast<float>(std::clamp(here.middle, std::min(least, here.middle), most));
            noise[n] = static_cast<float>(std::min(here.sigma, std::max(2.5 * outline.air_sigma, 0.02 * contrast)));
        }
        if (shell[n].size() >= kLeastSamples) tissue[n] = quantile(std::move(shell[n]), 0.95);
    }
    spread_known(map.air, map.size, static_cast<float>(outline.air));
    spread_known(noise, map.size, static_cast<float>(outline.air_sigma));
    spread_known(tissue, map.size, static_cast<float>(outline.tissue));
    smooth_nodes(map.air, map.size);
    smooth_nodes(noise, map.size);
    smooth_nodes(tissue, map.size);
    std::vector<float> sure(map.skin.size());
    for (std::size_t n = 0; n < map.skin.size(); ++n) {
        sure[n] = map.air[n] +
                  static_cast<float>(std::max(settings.least_noises * static_cast<double>(noise[n]), 0.02 * contrast));
        const double near_contrast = std::max(static_cast<double>(tissue[n] - map.air[n]), 0.1 * contrast);
        const double above =
            std::max(settings.share_of_tissue * near_contrast, settings.least_noises * static_cast<double>(noise[n]));
        map.skin[n] = settings.threshold != 0 ? std::max(static_cast<float>(settings.threshold),
                                                         map.air[n] + 1e-3F * static_cast<float>(contrast))
                                              : map.air[n] + static_cast<float>(std::min(above, 0.5 * near_contrast));
    }
    return sure;
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
        const std::vector<float> sure = learn(survey, values, settings, outline);
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
