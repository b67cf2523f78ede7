#include "segmentation/learn_levels.h"

#include <algorithm>
#include <cmath>

#include "planning_io/types/statistics.h"
#include "segmentation/distance_transform.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr double kBlock_mm = 20;  // of the level map
constexpr double kAirFrom_mm = 6, kAirTo_mm = 24;
constexpr double kShell_mm = 6;  // under the outline, for the tissue near by
constexpr std::size_t kLeastSamples = 60;

struct Spread {
    double middle = 0, sigma = 0;
};

Spread spread_of(std::vector<float> values) {
    Spread s{static_cast<double>(median(values)), 0};
    for (float& v : values) v = std::abs(v - static_cast<float>(s.middle));
    s.sigma = 1.4826 * static_cast<double>(median(std::move(values)));
    return s;
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

}  // namespace

std::vector<float> learn_levels(const HeadSurvey& survey, const std::vector<float>& values,
                                const OutlineSettings& settings, HeadOutline& outline) {
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

}  // namespace planlight
