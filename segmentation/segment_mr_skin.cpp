#include "segmentation/segment_mr_skin.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "planning_io/types/error.h"
#include "planning_io/types/statistics.h"
#include "segmentation/blank_places.h"
#include "segmentation/distance_transform.h"
#include "segmentation/head_outline.h"
#include "segmentation/outside_air.h"
#include "segmentation/skin_threshold.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr double kBandSteps = 3;       // of the survey, inwards from its outline
constexpr double kOuterBandSteps = 2;  // and outwards
constexpr double kSmoothing_mm = 1.2;  // standard deviation of one smoothing, at most
constexpr int kMostSmoothings = 3;
constexpr double kByThing_mm = 5;  // from what shines outside the head, no air's noise is learnt
constexpr double kLoudAir = 0.6;   // of the threshold: air that is louder is smoothed
constexpr double kLeastBody_ml = 50;

[[noreturn]] void refuse(const std::string& what) {
    throw InputError({}, "There is no skin in the volume: " + what,
                     "Check that the series shows the head with air round it, or give another threshold.");
}

/// One smoothing by w, 1 - 2w, w along each axis, where `w` keeps it within kSmoothing_mm also across thick slices;
/// only as far as the nodes near by ask for more than `done` of them: the mask, made step by step, and the surface,
/// made from the whole map, see the same values.
void smooth_once(Volume& volume, const LevelMap& map, int done) {
    const std::vector<float> before = volume.values;
    std::vector<float> asked = map.smoothings;
    for (float& times : asked) times = std::clamp(times - static_cast<float>(done), 0.0F, 1.0F);
    std::vector<float> next(volume.values.size());
    const std::array<std::size_t, 3> strides{1, volume.index(0, 1, 0), volume.index(0, 0, 1)};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double spacing = volume.spacing_mm()[static_cast<int>(axis)];
        const auto w = static_cast<float>(std::min(0.25, kSmoothing_mm * kSmoothing_mm / (2 * spacing * spacing)));
        const std::size_t stride = strides[axis], n = static_cast<std::size_t>(volume.size[axis]), slab = strides[2];
        tbb::parallel_for(0, volume.size[2], [&](int k) {
            const std::size_t begin = static_cast<std::size_t>(k) * slab;
            for (std::size_t v = begin; v < begin + slab; ++v) {
                const std::size_t at = v / stride % n;
                const float here = volume.values[v], low = at > 0 ? volume.values[v - stride] : here,
                            high = at + 1 < n ? volume.values[v + stride] : here;
                next[v] = std::isfinite(low + high) ? (1 - 2 * w) * here + w * (low + high) : here;
            }
        });
        std::swap(volume.values, next);
    }
    constexpr int kEvery = 4;
    tbb::parallel_for(0, volume.size[2], [&](int k) {
        for (int j = 0; j < volume.size[1]; ++j)
            for (int from = 0; from < volume.size[0]; from += kEvery) {
                const float share = value_at(map, asked, volume.ct_from_voxel * Vector3d(from + 0.5 * kEvery, j, k));
                for (int i = from; i < std::min(from + kEvery, volume.size[0]); ++i) {
                    const std::size_t v = volume.index(i, j, k);
                    volume.values[v] =
                        share >= 1 ? volume.values[v] : before[v] + share * (volume.values[v] - before[v]);
                }
            }
    });
}

/// How far each voxel of the survey lies outside (positive) or inside the outline, mm, as far as the band needs it.
std::vector<float> signed_distance(const HeadSurvey& survey, const Mask& head, double longest_mm) {
    std::vector<float> distance = distance_from(head, 1, survey.grid, longest_mm);
    const std::vector<float> depth = distance_from(head, 0, survey.grid, longest_mm);
    for (std::size_t v = 0; v < distance.size(); ++v)
        if (head[v]) distance[v] = -depth[v];
    return distance;
}

enum Place : std::uint8_t { kOutside = 0, kInside = 1, kBand = 2, kByThing = 3 };  // kByThing: outside, no air

/// For each voxel of the volume, where it lies to the outline.
Mask places_of(const Volume& volume, const HeadSurvey& survey, const HeadOutline& outline) {
    const double band_mm = kBandSteps * survey.step_mm(), outer_mm = kOuterBandSteps * survey.step_mm();
    const std::vector<float> distance = signed_distance(survey, outline.head, band_mm + 2 * survey.step_mm());
    const Mask by_thing = dilate(outline.gone, survey.grid, kByThing_mm);
    Mask places(volume.values.size());
    const Eigen::Affine3d survey_from_voxel =
        Eigen::Scaling(1 / survey.step_mm()) * Eigen::Translation3d(-survey.first_in_ct) * volume.ct_from_voxel;
    tbb::parallel_for(0, volume.size[2], [&](int k) {
        for (int j = 0; j < volume.size[1]; ++j)
            for (int i = 0; i < volume.size[0]; ++i) {
                const Vector3d at = survey_from_voxel * Vector3d(i, j, k);
                std::array<int, 3> s{};
                for (int a = 0; a < 3; ++a)
                    s[static_cast<std::size_t>(a)] = std::clamp(static_cast<int>(std::lround(at[a])), 0,
                                                                survey.grid.size[static_cast<std::size_t>(a)] - 1);
                const std::size_t near = survey.index(s[0], s[1], s[2]);
                const double d = static_cast<double>(distance[near]);
                places[volume.index(i, j, k)] = d <= -band_mm                                            ? kInside
                                                : outline.gone[near] || (d > outer_mm && by_thing[near]) ? kByThing
                                                : d > outer_mm                                           ? kOutside
                                                                                                         : kBand;
            }
    });
    return places;
}

/// The nodes of the map round which air is loud: of the voxels where it is sure one in fifty passes kLoudAir. What
/// shines outside the head (a coil's shell, a cushion) is no noise.
std::vector<std::uint8_t> loud_nodes(const Volume& leveled, const Mask& places, const LevelMap& map) {
    std::vector<std::vector<float>> air(map.air.size());
    for (std::size_t v = 0; v < places.size(); v += 3) {
        if (places[v] != kOutside || !std::isfinite(leveled.values[v])) continue;
        const auto row = static_cast<std::size_t>(leveled.size[0]), columns = static_cast<std::size_t>(leveled.size[1]);
        const Vector3d at =
            (leveled.ct_from_voxel * Vector3d(static_cast<double>(v % row), static_cast<double>(v / row % columns),
                                              static_cast<double>(v / row / columns)) -
             map.first_in_ct) /
            map.step_mm;
        std::size_t node = 0;
        for (int a = 2; a >= 0; --a)
            node = node * static_cast<std::size_t>(map.size[static_cast<std::size_t>(a)]) +
                   static_cast<std::size_t>(
                       std::clamp<long>(std::lround(at[a]), 0, map.size[static_cast<std::size_t>(a)] - 1));
        air[node].push_back(leveled.values[v]);
    }
    std::vector<std::uint8_t> loud(map.air.size(), 0);
    for (std::size_t n = 0; n < loud.size(); ++n)
        loud[n] = air[n].size() >= 50 && static_cast<double>(quantile(std::move(air[n]), 0.98)) > kLoudAir;
    return loud;
}

/// Smooths `leveled` where its air is loud, and there once more, and writes into the map how often.
void smooth_loud_places(Volume& leveled, const Mask& places, LevelMap& map, int& smoothings) {
    const VoxelGrid nodes{map.size, {1, 1, 1}};
    map.smoothings.assign(map.air.size(), 0);
    for (smoothings = 0; smoothings < kMostSmoothings;) {
        Mask loud = loud_nodes(leveled, places, map);
        if (std::find(loud.begin(), loud.end(), 1) == loud.end()) break;
        loud = dilate(loud, nodes, 1.5);  // the nodes within the head know no air
        for (std::size_t n = 0; n < loud.size(); ++n)
            if (loud[n] && map.smoothings[n] == static_cast<float>(smoothings)) map.smoothings[n] += 1;
        smooth_once(leveled, map, smoothings);
        ++smoothings;
    }
}

/// Whether the air round the head shows anything but the blank value. What is left of it once the blank is forgotten
/// says so: where a scanner sets low values to 0, single specks of noise stay, which are no air that can be measured.
bool is_not_air(const HeadSurvey& without_blank, const HeadSurvey& survey, const Mask& head) {
    const std::vector<float> away = distance_from(head, 1, survey.grid, 30);
    std::size_t air = 0, blank_air = 0;
    for (std::size_t v = 0; v < head.size(); ++v)
        if (survey.measured[v] && away[v] > 6 && away[v] < 24) ++air, blank_air += !without_blank.measured[v];
    return 2 * blank_air < air;
}

double brightness_ratio(const LevelMap& levels) {
    std::vector<float> above;
    for (std::size_t n = 0; n < levels.air.size(); ++n) above.push_back(levels.skin[n] - levels.air[n]);
    std::sort(above.begin(), above.end());
    return static_cast<double>(above[above.size() * 49 / 50] / above[above.size() / 50]);
}

}  // namespace

Volume leveled_values(const Volume& volume, const SkinMask& mask) {
    Volume leveled = volume;
    if (mask.blank) forget_blank(leveled, *mask.blank);
    return in_levels(std::move(leveled), mask.levels);
}

Volume skin_values(const Volume& volume, const SkinMask& mask) {
    Volume leveled = leveled_values(volume, mask);
    for (int n = 0; n < mask.smoothings; ++n) smooth_once(leveled, mask.levels, n);
    return leveled;
}

SkinMask segment_mr_skin(const Volume& volume, const SkinSettings& settings,
                         const std::function<void(double)>& progress) {
    const auto report = [&](double done) {
        if (progress) progress(done);
    };
    HeadSurvey survey = survey_of(volume);
    report(0.2);
    OutlineSettings of_outline;
    of_outline.threshold = settings.threshold;
    of_outline.seal_radius_mm = settings.seal_radius_mm;
    of_outline.detach_radius_mm = settings.detach_radius_mm;
    HeadOutline outline = outline_of(survey, of_outline);
    SkinMask result;
    Volume leveled = volume;
    if (const auto blank = blank_value(volume); blank && outline.volume_ml > 0) {
        forget_blank(leveled, *blank);
        HeadSurvey without_blank = survey_of(leveled);
        if (without_blank.has_rim() && is_not_air(without_blank, survey, outline.head)) {
            result.blank = blank;
            survey = std::move(without_blank);
            outline = outline_of(survey, of_outline);
        } else {
            leveled = volume;
        }
    }
    if (outline.volume_ml <= 0 || outline.levels.empty()) refuse("nothing thick stands out against the air");
    if (outline.volume_ml < kLeastBody_ml)
        refuse(fmt::format("the largest piece denser than {} has {:.1f} ml",
                           threshold_text(middle_threshold(outline.levels)), outline.volume_ml));
    report(0.5);

    result.levels = outline.levels;
    result.threshold = 1;
    result.threshold_said = middle_threshold(outline.levels);
    result.brightness_ratio = brightness_ratio(outline.levels);
    result.unsure_share = outline.unsure_share;
    const Mask places = places_of(volume, survey, outline);
    leveled = in_levels(std::move(leveled), result.levels);
    smooth_loud_places(leveled, places, result.levels, result.smoothings);
    Mask body(places.size());
    for (std::size_t v = 0; v < body.size(); ++v)
        body[v] = places[v] == kInside || (places[v] == kBand && leveled.values[v] >= 1);
    const VoxelGrid grid = grid_of(volume);
    body = largest_piece(std::move(body), grid).mask;
    report(0.7);
    result.body = outside_air_sealed(body, grid, settings.seal_radius_mm);
    std::size_t voxels = 0;
    for (auto& v : result.body) voxels += v = !v;
    if (voxels == result.body.size()) refuse("no air round the body");
    result.volume_ml = static_cast<double>(voxels) * grid.voxel_ml();
    Mask away(body.size());
    for (std::size_t v = 0; v < body.size(); ++v) away[v] = !result.body[v] && leveled.values[v] >= 1;
    for (std::size_t v = 0; v < away.size(); ++v) {
        if (away[v] != 1) continue;
        const double ml = static_cast<double>(flood(away, grid, {v}, 1, 2)) * grid.voxel_ml();
        if (ml < 0.05) continue;
        ++result.pieces_removed;
        result.removed_ml += ml;
    }
    report(1);
    return result;
}

}  // namespace planlight
