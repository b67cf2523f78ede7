#include "projection/check_light.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "planning_io/types/statistics.h"
#include "projection/far_light.h"
#include "projection/figure_patch.h"
#include "projection/find_light.h"
#include "projection/light_depth.h"
#include "projection/render_drawing.h"
#include "projection/stroke_places.h"
#include "projection/sum_up_light.h"

namespace planlight {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// A segment as both cameras see it.
struct LookedAt {
    SeenSegment segment;  ///< without what is joined of the two
    std::array<CameraLook, 2> looks;
    std::array<double, 2> slopes{};  ///< `sideways_slope` of the cameras
    double projector_slope = 0;
};

/// Where the devices stand, in frame ct.
struct DevicesInCt {
    std::array<Vector3d, 2> cameras;
    Vector3d projector;
};

LookedAt looked_at(const StrokeSegment& segment, const std::array<CameraLook, 2>& looks, const DevicesInCt& devices) {
    const StrokePlace& middle = segment.middle();
    LookedAt result;
    SeenSegment& seen = result.segment;
    seen.item = segment.item;
    seen.p_in_ct = middle.p_in_ct;
    seen.sideways_in_ct = middle.sideways_in_ct;
    seen.normal_in_ct = middle.normal_in_ct;
    seen.tick = segment.tick;
    result.looks = looks;
    result.projector_slope = sideways_slope(seen, devices.projector);
    for (std::size_t c = 0; c < 2; ++c) {
        result.slopes[c] = sideways_slope(seen, devices.cameras[c]);
        if (looks[c].asked) seen.background += looks[c].background / (looks[0].asked && looks[1].asked ? 2 : 1);
        if (!looks[c].light) continue;
        seen.seen = true;
        seen.by_camera_mm[c] = looks[c].light->off_mm;
        seen.brighter = std::max(seen.brighter, looks[c].light->brighter);
    }
    return result;
}

double variance_of(const CameraLook& look, const CheckLightSettings& settings) {
    return std::pow(look.light->sigma_mm, 2) + std::pow(settings.place_sigma_mm, 2);
}

/// A stretch of an item, those beside it, and the item's ticks near by: along the cameras' base a line tells no height
/// by itself.
std::vector<LookedAt*> beside(std::size_t i, std::span<LookedAt* const> item, std::size_t step,
                              const CheckLightSettings& settings) {
    const double reach_mm = 1.7 * settings.segment_mm * static_cast<double>(step);
    const SeenSegment& middle = item[i]->segment;
    std::vector<LookedAt*> result{item[i]};
    for (const std::size_t k : {i - 1, i + 1})  // none before the first
        if (k < item.size() && side_by_side(item[k]->segment, middle, step, settings)) result.push_back(item[k]);
    for (LookedAt* other : item)
        if (other != item[i] && other->segment.tick && (other->segment.p_in_ct - middle.p_in_ct).norm() < reach_mm)
            result.push_back(other);
    return result;
}

/// How far above the drawing's skin the light of some stretches lies, however badly they tell it.
std::optional<LightDepth> rough_depth_of(std::span<LookedAt* const> stretches, const CheckLightSettings& settings) {
    std::vector<SeenDepth> apart;
    for (const LookedAt* s : stretches)
        if (s->looks[0].light && s->looks[1].light)
            apart.push_back({s->looks[0].light->off_mm - s->looks[1].light->off_mm, s->slopes[1] - s->slopes[0],
                             std::sqrt(variance_of(s->looks[0], settings) + variance_of(s->looks[1], settings))});
    return fit_depth(apart);
}

/// Empty where it is not told well.
std::optional<LightDepth> depth_of(std::span<LookedAt* const> stretches, const CheckLightSettings& settings) {
    const auto depth = rough_depth_of(stretches, settings);
    return depth && told_well(*depth) ? depth : std::nullopt;
}

/// `ItemLight::by_untold_height_mm`. Each stretch is told by all of the item that lies round it: the item's other parts
/// need not speak for it, for the skin may have risen under it alone. Of one stretch alone little is told: the second
/// worst.
double by_untold_height_mm(std::span<LookedAt* const> item, std::size_t step, const CheckLightSettings& settings) {
    const double reach_mm = 2.2 * settings.segment_mm * static_cast<double>(step);
    double most = 0, second = 0;
    for (const LookedAt* middle : item) {
        if (middle->segment.tick || !middle->segment.seen) continue;
        std::vector<LookedAt*> around;
        std::vector<SeenAside> seen;
        for (LookedAt* s : item) {
            if ((s->segment.p_in_ct - middle->segment.p_in_ct).norm() > reach_mm) continue;
            around.push_back(s);
            for (std::size_t c = 0; c < 2; ++c)
                if (s->looks[c].light) seen.push_back({s->looks[c].light->off_mm, s->projector_slope, s->slopes[c]});
        }
        const auto depth = rough_depth_of(around, settings);
        if (depth && told_well(*depth)) continue;
        const double aside_mm = aside_by_untold_height_mm(seen, depth);
        second = std::max(second, std::min(most, aside_mm));
        most = std::max(most, aside_mm);
    }
    return second;
}

/// 0 where it is not clearly from nothing.
double clear_depth(const LightDepth& depth, const CheckLightSettings& settings) {
    return std::abs(depth.mm) > std::max(settings.least_depth_mm, 3 * depth.sigma_mm) ? depth.mm : 0;
}

/// Of one stretch: where what is seen beside it clearly tells another depth than all of the item does, for the skin may
/// have risen under a part of it.
double depth_at(std::span<LookedAt* const> beside, double of_item_mm, const CheckLightSettings& settings) {
    const auto depth = beside.size() > 1 ? depth_of(beside, settings) : std::nullopt;
    if (!depth || clear_depth({depth->mm - of_item_mm, depth->sigma_mm}, settings) == 0) return of_item_mm;
    return clear_depth(*depth, settings);
}

/// What both cameras say of a segment on skin that is `depth_mm` higher: the mean by weight where they agree; the
/// nearer one where they do not (one of them took something else for the light).
SeenSegment joined(const LookedAt& looked, double depth_mm, const CheckLightSettings& settings) {
    SeenSegment result = looked.segment;
    if (!result.seen) return result;
    double weight = 0, sum = 0, flat = 0;
    std::array<double, 2> off{};
    for (std::size_t c = 0; c < 2; ++c) {
        if (!looked.looks[c].light) continue;
        const double w = 1 / variance_of(looked.looks[c], settings);
        off[c] = looked.looks[c].light->off_mm + depth_mm * looked.slopes[c];
        weight += w;
        sum += w * off[c];
        flat += w * looked.looks[c].light->off_mm;
    }
    result.off_mm = sum / weight;
    result.by_depth_mm = (sum - flat) / weight;
    result.sigma_mm = 1 / std::sqrt(weight);
    if (result.by_camera_mm[0] && result.by_camera_mm[1]) {
        const double apart = std::abs(off[0] - off[1]);
        const std::size_t nearer = std::abs(off[0]) < std::abs(off[1]) ? 0 : 1;
        if (apart > 1) {
            result.off_mm = off[nearer];
            result.by_depth_mm = off[nearer] - *result.by_camera_mm[nearer];
        }
        result.sigma_mm = std::hypot(result.sigma_mm, apart / 2);
    }
    return result;
}

/// Item by item, for each has its own height of the skin, and so may parts of it.
void join(std::vector<LookedAt>& looked, std::size_t step, const CheckLightSettings& settings, LightCheck& check) {
    std::vector<std::vector<LookedAt*>> of_item(check.items.size());
    for (LookedAt& one : looked) of_item[static_cast<std::size_t>(one.segment.item)].push_back(&one);
    for (std::size_t i = 0; i < of_item.size(); ++i) {
        const auto depth = depth_of(of_item[i], settings);
        const double depth_mm = depth ? clear_depth(*depth, settings) : 0;
        if (depth_mm != 0) check.items[i].depth_mm = depth_mm;
        check.items[i].by_untold_height_mm = by_untold_height_mm(of_item[i], step, settings);
        for (std::size_t k = 0; k < of_item[i].size(); ++k) {
            const double here_mm = depth_at(beside(k, of_item[i], step, settings), depth_mm, settings);
            check.segments.push_back(joined(*of_item[i][k], here_mm, settings));
        }
    }
}

/// Who sees a segment: the projector lights all of it, and which cameras see it freely where it can be measured.
struct Sight {
    bool known = false, lit = false, measurable = false;
    std::array<bool, 2> seen{};
};

}  // namespace

struct LightChecker::Parts {
    const SkinSurface& skin;
    const RigCalibration& rig;
    CheckLightSettings settings;
    std::vector<ItemLight> items;                   ///< what is the same in each look
    std::vector<std::optional<StrokePlace>> apart;  ///< of each item without a segment, a place on it
    std::vector<StrokeSegment> segments;
    std::vector<FigurePatch> patches;
    std::vector<StrokeSegment> crowded;  ///< beside another item's light: nobody looks, but they are lit
    std::vector<Sight> sights;           ///< of the segments, then of the patches, then of the crowded
    std::optional<std::size_t> bright_item{};
    std::size_t turn = 0;
    int frame = 0;
    bool nothing_far = false;  ///< by the last search of all the light as one
    bool passed_over = false;  ///< that search was left out in the last look
    std::optional<RigidTransform> last{};

    bool dim(int item) const { return bright_item && item != static_cast<int>(*bright_item); }
    const StrokeSegment& sighted(std::size_t i) const;  ///< what `sights[i]` is of
    Sight sight_of(const StrokeSegment& segment, const RigidTransform& rig_from_ct) const;
    void look_around(const RigidTransform& rig_from_ct);
    void look_at(const FigurePatch& patch, const Sight& sight, const RigidTransform& rig_from_ct,
                 const StereoFrame& pictures, const DevicesInCt& devices, std::vector<LookedAt>& looked) const;
    std::optional<double> far_light(const RigidTransform& rig_from_ct, const StereoFrame& pictures) const;
};

const StrokeSegment& LightChecker::Parts::sighted(std::size_t i) const {
    if (i < segments.size()) return segments[i];
    i -= segments.size();
    return i < patches.size() ? patches[i].extent : crowded[i - patches.size()];
}

Sight LightChecker::Parts::sight_of(const StrokeSegment& segment, const RigidTransform& rig_from_ct) const {
    const auto free = [&](const CameraModel& device, double steepest) {
        for (const StrokePlace* place : {&segment.places.front(), &segment.middle(), &segment.places.back()})
            if (!freely_seen(*place, skin, device, rig_from_ct, steepest)) return false;
        return true;
    };
    Sight sight;
    sight.known = true;
    sight.measurable = free(rig.projector, settings.steepest);
    sight.lit = sight.measurable || free(rig.projector, settings.steepest_lit);
    if (sight.measurable)
        sight.seen = {free(rig.left_camera, settings.steepest), free(rig.right_camera, settings.steepest)};
    return sight;
}

/// A part of the segments anew each frame; all after the head has gone elsewhere.
void LightChecker::Parts::look_around(const RigidTransform& rig_from_ct) {
    constexpr double kElsewhere_mm = 10, kElsewhere = 0.09;  // 5 degrees
    const bool elsewhere = !last || (last->translation() - rig_from_ct.translation()).norm() > kElsewhere_mm ||
                           angle_between(*last, rig_from_ct) > kElsewhere;
    if (elsewhere)
        for (Sight& sight : sights) sight.known = false;
    last = rig_from_ct;
    const int parts = std::max(1, settings.look_again_every);
    for (std::size_t i = 0; i < sights.size(); ++i)
        if (!sights[i].known || static_cast<int>(i) % parts == frame % parts)
            sights[i] = sight_of(sighted(i), rig_from_ct);
    ++frame;
}

/// A small figure counts as two stretches, square to each other.
void LightChecker::Parts::look_at(const FigurePatch& patch, const Sight& sight, const RigidTransform& rig_from_ct,
                                  const StereoFrame& pictures, const DevicesInCt& devices,
                                  std::vector<LookedAt>& looked) const {
    std::array<std::array<CameraLook, 2>, 2> by_camera;
    if (sight.seen[0]) by_camera[0] = find_figure(patch, rig.left_camera, rig_from_ct, pictures.left, settings);
    if (sight.seen[1]) by_camera[1] = find_figure(patch, rig.right_camera, rig_from_ct, pictures.right, settings);
    for (std::size_t side = 0; side < 2; ++side) {
        const std::array<CameraLook, 2> looks{by_camera[0][side], by_camera[1][side]};
        if (looks[0].asked || looks[1].asked) looked.push_back(looked_at(patch.sides[side], looks, devices));
    }
}

std::optional<double> LightChecker::Parts::far_light(const RigidTransform& rig_from_ct,
                                                     const StereoFrame& pictures) const {
    std::vector<SightedSegment> lit;
    for (std::size_t i = 0; i < segments.size(); ++i)
        if (sights[i].measurable && !segments[i].tick && !dim(segments[i].item))
            lit.push_back({&segments[i], sights[i].seen});
    for (std::size_t i = 0; i < patches.size(); ++i)
        for (const StrokeSegment& piece : patches[i].outline)
            if (sights[segments.size() + i].measurable)
                lit.push_back({&piece, sights[segments.size() + i].seen, patches[i].small_ring});
    return find_far_light(lit, skin, rig, rig_from_ct, pictures);
}

LightChecker::LightChecker(const PlanDrawing& drawing, const SkinSurface& skin, const RigCalibration& rig,
                           const CheckLightSettings& settings, std::optional<std::size_t> bright_item)
    : parts_(new Parts{skin, rig, settings, {}, {}, segments_of(drawing, settings), {}, {}, {}}) {
    parts_->bright_item = bright_item;
    parts_->patches = patches_of(drawing, skin, parts_->segments, settings, bright_item);
    parts_->crowded = crowded_segments_of(drawing, parts_->segments, settings);
    parts_->apart = places_of_items(drawing);
    for (std::size_t i = 0; i < parts_->apart.size(); ++i)
        if (parts_->dim(static_cast<int>(i))) parts_->apart[i].reset();
    parts_->sights.resize(parts_->segments.size() + parts_->patches.size() + parts_->crowded.size());
    for (const StrokeSegment& segment : parts_->segments) parts_->apart[static_cast<std::size_t>(segment.item)].reset();
    const std::vector<double> extents_mm = extents_of_items_mm(drawing);
    for (std::size_t i = 0; i < drawing.items.size(); ++i) {
        ItemLight& item = parts_->items.emplace_back();
        item.name = drawing.items[i].name;
        item.dim = parts_->dim(static_cast<int>(i));
        item.extent_mm = extents_mm[i];
    }
}
LightChecker::~LightChecker() = default;
LightChecker::LightChecker(LightChecker&&) noexcept = default;

LightCheck LightChecker::look(const RigidTransform& rig_from_ct, const StereoFrame& frame) {
    Parts& p = *parts_;
    LightCheck check;
    check.items = p.items;
    p.look_around(rig_from_ct);
    for (std::size_t i = 0; i < p.items.size(); ++i)
        check.items[i].lit =
            p.apart[i] && freely_seen(*p.apart[i], p.skin, p.rig.projector, rig_from_ct, p.settings.steepest_lit);
    for (std::size_t i = 0; i < p.segments.size(); ++i)
        if (p.sights[i].lit) check.items[static_cast<std::size_t>(p.segments[i].item)].lit = true;
    const std::size_t segments = p.segments.size(), crowded = segments + p.patches.size();
    const std::size_t most = std::max<std::size_t>(1, p.settings.most_segments);
    const std::size_t step = std::max<std::size_t>(1, (p.sights.size() + most - 1) / most);
    const RigidTransform ct_from_rig = rig_from_ct.inverse();
    const DevicesInCt devices{
        {ct_from_rig * p.rig.left_camera.centre_in_rig(), ct_from_rig * p.rig.right_camera.centre_in_rig()},
        ct_from_rig * p.rig.projector.centre_in_rig()};
    std::vector<LookedAt> looked;
    for (std::size_t i = p.turn++ % step; i < p.sights.size(); i += step) {
        const Sight& sight = p.sights[i];
        if (!sight.lit) continue;
        const StrokeSegment& segment = p.sighted(i);
        const int counts = i >= crowded ? 1 : i >= segments ? 2 : segment.tick ? 0 : 1;
        if (!p.dim(segment.item)) check.lit += counts;
        ItemLight& item = check.items[static_cast<std::size_t>(segment.item)];
        item.lit_segments += counts;
        item.steep_segments += sight.measurable ? 0 : counts;
        if (i >= crowded) continue;
        if (i >= segments) {
            p.look_at(p.patches[i - segments], sight, rig_from_ct, frame, devices, looked);
            continue;
        }
        std::array<CameraLook, 2> looks;
        if (sight.seen[0]) looks[0] = find_light(segment, p.rig.left_camera, rig_from_ct, frame.left, p.settings);
        if (sight.seen[1]) looks[1] = find_light(segment, p.rig.right_camera, rig_from_ct, frame.right, p.settings);
        if (looks[0].asked || looks[1].asked) looked.push_back(looked_at(segment, looks, devices));
    }
    join(looked, step, p.settings, check);
    sum_up_light(step, p.settings, check);
    constexpr double kMostSeen = 0.8, kAside_mm = 1;  // else light is where it was looked for
    const bool missed = check.expected > 0 && (check.seen_share() < kMostSeen || check.off_mm > kAside_mm);
    // As long as nothing is found, every second look: it costs more than the rest.
    p.passed_over = p.settings.far_too && missed && p.nothing_far && !p.passed_over;
    if (p.settings.far_too && missed && !p.passed_over) {
        check.far_mm = p.far_light(rig_from_ct, frame);
        p.nothing_far = !check.far_mm;
    }
    return check;
}

void note_lit_items(const RenderCounts& shown, LightCheck& check) {
    constexpr double kSome = 0.05;
    for (std::size_t i = 0; i < std::min(check.items.size(), shown.items.size()); ++i)
        check.items[i].lit = check.items[i].lit || shown.items[i].lit_share() > kSome;
}

LightCheck check_light(const PlanDrawing& drawing, const SkinSurface& skin, const RigCalibration& rig,
                       const RigidTransform& rig_from_ct, const StereoFrame& frame,
                       const CheckLightSettings& settings) {
    return LightChecker(drawing, skin, rig, settings).look(rig_from_ct, frame);
}

}  // namespace planlight
