#include "segmentation/skin_layers.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "planning_io/types/statistics.h"
#include "planning_io/volume/volume_sample.h"
#include "segmentation/triangle_area.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr double kStep_mm = 0.5;
constexpr int kOut = 16, kIn = 100;  // samples before and under the skin: 8 and 50 mm
constexpr std::size_t kMostSamples = 12000;
constexpr int kFewSamples = 50;
constexpr double kBone_hu = 300, kSoftFrom_hu = -200, kSoftTo_hu = 150, kAir_hu = -500;
constexpr double kBoneFrom_mm = 2, kBoneTo_mm = 16;  // under the skin
constexpr double kBrainFrom_mm = 22, kBrainTo_mm = 45;
constexpr double kDark = 0.55;   // of the brain: bone with what thick voxels add to it
constexpr double kBright = 1.6;  // of the brain: bone in a CT that is not in HU
constexpr double kPatch_mm = 25, kPatchBoneless = 0.9, kLayeredAllOver = 0.5;
constexpr double kLight_hu = -120, kLightAt_mm = 2, kLightAt_blurs = 0.75;  // fat is denser
constexpr double kLightPatch_mm = 15, kPatchLight = 0.7;
constexpr double kThinMatter_mm = 3.5, kGap_mm = 3;

/// Values from 8 mm before the skin (index 0) to 50 mm under it.
using Profile = std::vector<float>;

struct Sample {
    std::size_t vertex = 0;
    bool vault = false, beside = false;  ///< beside: where ears are
    bool round_vault = false;            ///< the vault, its sides and its back
    bool upper = false;                  ///< the vault, and behind down to where the neck's muscles begin
    Vector3d at_in_ct;
    Profile values;
    double at(double depth_mm) const {
        const auto index = std::lround(depth_mm / kStep_mm) + kOut;
        return index < 0 || index >= static_cast<long>(values.size())
                   ? NAN
                   : static_cast<double>(values[static_cast<std::size_t>(index)]);
    }
};

double median_between(const Sample& s, double from_mm, double to_mm) {
    std::vector<double> values;
    for (double d = from_mm; d <= to_mm; d += kStep_mm)
        if (const double v = s.at(d); std::isfinite(v)) values.push_back(v);
    return values.empty() ? NAN : median(std::move(values));
}

/// To the patient's back, or to that of a head which looks aside.
Vector3d back_of(const MiddlePlane& plane) {
    const Vector3d left = plane.left_in_ct();
    return Vector3d(-left.y(), left.x(), 0).normalized();
}

std::vector<Sample> samples_of(const Volume& values, const TriangleMesh& skin, const Vector3d& centre,
                               const MiddlePlane& plane) {
    const Vector3d left = plane.looks_aside() ? plane.left_in_ct() : Vector3d::UnitX(),
                   back = plane.looks_aside() ? back_of(plane) : Vector3d::UnitY();
    std::vector<std::size_t> vertices;
    for (std::size_t v = 0; v < skin.vertices_in_ct.size(); ++v)
        if (skin.flags.empty() || skin.flags[v] == kSkin) vertices.push_back(v);
    const std::size_t stride = std::max<std::size_t>(1, vertices.size() / kMostSamples);
    std::vector<Sample> samples((vertices.size() + stride - 1) / stride);
    const Eigen::Affine3d voxel_from_ct = values.ct_from_voxel.inverse();
    tbb::parallel_for(std::size_t{0}, samples.size(), [&](std::size_t n) {
        Sample& s = samples[n];
        s.vertex = vertices[n * stride];
        const Vector3d& p = skin.vertices_in_ct[s.vertex];
        const Vector3d away = (p - centre).normalized();
        // Above the skull's middle, not the face, and where the surface looks outwards (not behind an ear).
        s.beside = std::abs(away.dot(left)) > 0.75;
        s.at_in_ct = p;
        s.upper = (away.z() > 0.2 || (away.z() > -0.15 && away.dot(back) > 0.5)) &&
                  skin.normals_in_ct[s.vertex].dot(away) > 0.7;
        const bool outwards = skin.normals_in_ct[s.vertex].dot(away) > 0.7;
        s.vault = away.z() > 0.2 && outwards;
        s.round_vault = away.z() > -0.35 && away.dot(back) > -0.5 && outwards;
        const Vector3d inwards = voxel_from_ct.linear() * (-kStep_mm * skin.normals_in_ct[s.vertex]),
                       at = voxel_from_ct * p;
        for (int i = -kOut; i <= kIn; ++i)
            s.values.push_back(static_cast<float>(value_at(values, at + i * inwards).value_or(NAN)));
    });
    if (std::count_if(samples.begin(), samples.end(), [](const Sample& s) { return s.vault; }) < kFewSamples)
        for (Sample& s : samples) s.vault = s.round_vault;  // the volume ends above: what it shows of the skull
    return samples;
}

/// Way from 80 to 20 % of the step from the air before the skin to the first 4 mm under it; not a number without a
/// step.
double blur_of(const Sample& s) {
    const double air = median_between(s, -6, -3);
    double crest = -INFINITY;
    for (double d = 0; d <= 5; d += kStep_mm)
        if (s.at(d) > crest) crest = s.at(d);
    if (!(crest > air)) return NAN;
    double high = NAN, low = NAN;
    for (double d = 5; d >= -6; d -= kStep_mm) {
        const double share = (s.at(d) - air) / (crest - air);
        if (share >= 0.8) high = d;
        if (std::isnan(low) && !std::isnan(high) && share < 0.2) low = d;
    }
    return high - low;
}

bool stands_off(const Sample& s, double air, double matter) {
    double thick = 0, gap = 0;
    for (double d = 0.5; d <= 14; d += kStep_mm) {
        const double v = s.at(d);
        if (v > matter && gap == 0) thick += kStep_mm;
        if (v < air) gap += kStep_mm;
        if (thick > kThinMatter_mm) return false;
        if (gap > kGap_mm) return thick > 0;
    }
    return false;
}

/// The bone's depth under the vault's skin in HU; not a number where there is none, or no soft tissue under it.
double bone_in_hu(const Sample& s, const CtGreys& greys) {
    const double bone = greys.of(kBone_hu), most = greys.of(kSoftTo_hu), least = greys.of(kSoftFrom_hu);
    for (double d = 0; d <= 25; d += kStep_mm)
        if (s.at(d) > bone) {
            for (double under = d; under <= d + 25; under += kStep_mm)
                if (s.at(under) < most && s.at(under) > least) return d;
            return NAN;
        }
    return NAN;
}

/// Whether the values 5 to 8 mm before the skin are one and the same nearly everywhere.
bool is_blank(const std::vector<Sample>& samples, float threshold) {
    std::vector<float> before;
    for (const Sample& s : samples)
        for (double d = -8; d <= -5; d += kStep_mm)
            if (std::isfinite(s.at(d))) before.push_back(static_cast<float>(s.at(d)));
    if (before.empty()) return false;
    return quantile(before, 0.7) - quantile(before, 0.05) < 0.01F * std::max(1.0F, std::abs(threshold));
}

struct Layer {
    bool dark = false, bright = false, faint = false;
    double depth_mm = NAN, level = NAN;
};

/// The layer of bone between scalp and brain, of values whose air is 0: darker than both, or (`bright`) brighter than
/// both.
Layer bone_of(const Sample& s, double brain) {
    Layer layer;
    std::vector<double> over, under;  // the brightest so far, and within 14 mm further on
    for (double d = 0; d <= kBoneTo_mm; d += kStep_mm) {
        over.push_back(std::max(over.empty() ? -INFINITY : over.back(), s.at(d)));
        double most_under = -INFINITY;
        for (double u = d; u <= d + 14; u += kStep_mm) most_under = std::max(most_under, s.at(u));
        under.push_back(most_under);
    }
    double ratio = INFINITY, least_at = kBoneFrom_mm, most = -INFINITY, most_at = 0;
    std::size_t dip = 0, at = 0;
    for (double d = 0; d <= kBoneTo_mm; d += kStep_mm, ++at) {
        const double v = s.at(d), of = std::min(over[at], under[at]);
        if (d >= kBoneFrom_mm && v > most) most = v, most_at = d;
        if (d < 1 || !(of > 0) || !(v / of < ratio)) continue;
        ratio = v / of;
        least_at = d;
        dip = at;
    }
    const double least = s.at(least_at);
    double over_bright = INFINITY;
    for (double d = 1; d < most_at; d += kStep_mm) over_bright = std::min(over_bright, s.at(d));
    layer.level = least / brain;
    layer.dark = least < kDark * brain && ratio < 0.7 && under[dip] > 0.5 * brain;
    layer.faint = ratio < 0.85;
    layer.bright = most > kBright * brain && over_bright < 0.75 * most &&
                   median_between(s, most_at + 8, most_at + 20) < 0.75 * most;
    layer.depth_mm = layer.dark ? least_at : most_at;
    return layer;
}

std::size_t count_near(const std::vector<Vector3d>& all, const Vector3d& p, double within_mm) {
    return static_cast<std::size_t>(
        std::count_if(all.begin(), all.end(), [&](const Vector3d& q) { return (p - q).norm() < within_mm; }));
}

/// Those of `odd` that lie by a place where hardly any of `others` do.
std::vector<Vector3d> patches_of(const std::vector<Vector3d>& odd, const std::vector<Vector3d>& others, double patch_mm,
                                 double least_share) {
    std::vector<Vector3d> middles, patches;
    for (const Vector3d& p : odd)
        if (const auto n = static_cast<double>(count_near(odd, p, patch_mm));
            n > least_share * (n + static_cast<double>(count_near(others, p, patch_mm))))
            middles.push_back(p);
    for (const Vector3d& p : odd)
        if (count_near(middles, p, patch_mm) > 0) patches.push_back(p);
    return patches;
}

/// The largest area of samples without bone that have hardly any with bone within kPatch_mm: share of all samples.
template <typename HasBone>
double boneless_share(const std::vector<Sample>& samples, HasBone&& has_bone) {
    std::vector<Vector3d> boneless, bony;
    for (const Sample& s : samples)
        if (s.upper) (has_bone(s) ? bony : boneless).push_back(s.at_in_ct);
    return static_cast<double>(patches_of(boneless, bony, kPatch_mm, kPatchBoneless).size()) /
           static_cast<double>(samples.size());
}

/// Where all that lies just under the surface is lighter than skin and fat; deeper where the edge is less sharp, or
/// slices are thick.
std::vector<Vector3d> light_patches(const std::vector<Sample>& samples, const Volume& volume, const TriangleMesh& skin,
                                    double edge_blur_mm, double light) {
    std::vector<Vector3d> lighter, others;
    const Eigen::Matrix3d voxel_from_ct = volume.ct_from_voxel.linear().inverse();
    for (const Sample& s : samples) {
        const Vector3d& out = skin.normals_in_ct[s.vertex];
        const double step_mm = 1 / (voxel_from_ct * out).norm();
        const double at_mm = std::max({kLightAt_mm, kLightAt_blurs * step_mm, kLightAt_blurs * edge_blur_mm});
        double most = -INFINITY;  // thin skin over fat is denser further out
        for (double d = at_mm / 2; d <= at_mm; d += kStep_mm / 2) most = std::max(most, s.at(d));
        if (std::isfinite(most)) (most < light ? lighter : others).push_back(s.at_in_ct);
    }
    return patches_of(lighter, others, kLightPatch_mm, kPatchLight);
}

}  // namespace

SkinLayers layers_under(const Volume& volume, const SkinMask& mask, const TriangleMesh& skin,
                        const Vector3d& centre_in_ct, const MiddlePlane& plane, const CtGreys& greys) {
    const Volume leveled = mask.levels.empty() ? Volume() : skin_values(volume, mask);
    const Volume& values = mask.levels.empty() ? volume : leveled;
    const std::vector<Sample> samples = samples_of(values, skin, centre_in_ct, plane);
    SkinLayers layers;
    std::vector<double> brains, blurs, depths, levels;
    for (const Sample& s : samples) {
        if (const double blur = blur_of(s); std::isfinite(blur)) blurs.push_back(blur);
        if (const double brain = median_between(s, kBrainFrom_mm, kBrainTo_mm); s.vault && std::isfinite(brain))
            brains.push_back(brain);
    }
    layers.edge_blur_mm = median(std::move(blurs));
    const double brain = brains.empty() ? NAN : median(std::move(brains));
    const double air = volume.is_hu ? kAir_hu : 0.5 * mask.threshold, matter = volume.is_hu ? kAir_hu : mask.threshold;
    double vault = 0, layered = 0, bright = 0, faint = 0, off = 0;
    for (const Sample& s : samples) {
        off += !s.beside && stands_off(s, air, matter);
        if (!s.vault) continue;
        ++vault;
        if (volume.is_hu) {
            const double depth = bone_in_hu(s, greys);
            layered += std::isfinite(depth);
            if (std::isfinite(depth)) depths.push_back(depth);
            continue;
        }
        const Layer layer = bone_of(s, brain);
        layered += layer.dark;
        bright += layer.bright;
        faint += layer.faint;
        if (std::isfinite(layer.level)) levels.push_back(layer.level);
        if (layer.dark || layer.bright) depths.push_back(layer.depth_mm);
    }
    layers.bright_bone = bright > 0.5 * vault && layered < 0.3 * vault;
    layers.layered_share = vault < kFewSamples ? NAN : (layers.bright_bone ? bright : layered) / vault;
    layers.faint_share = vault < kFewSamples ? NAN : faint / vault;
    layers.air_is_blank = is_blank(samples, static_cast<float>(mask.threshold));
    layers.scalp_mm = depths.empty() ? NAN : median(std::move(depths));
    layers.dip = levels.empty() ? NAN : median(std::move(levels));
    double area_cm2 = 0;
    for (const auto& t : skin.triangles) area_cm2 += area_in_ct(skin, t).norm() / 100;
    if (!layers.bright_bone && layers.layered_share > kLayeredAllOver)
        layers.boneless_cm2 = area_cm2 * boneless_share(samples, [&](const Sample& s) {
                                  return volume.is_hu ? bone_in_hu(s, greys) <= kBoneTo_mm : bone_of(s, brain).dark;
                              });
    constexpr double kBlended_mm = 3;  // between slices so far apart what was laid there is a blend of air and skin
    if (volume.is_hu && !samples.empty() && volume.widest_gap_mm <= kBlended_mm) {
        layers.light_in_ct = light_patches(samples, volume, skin, layers.edge_blur_mm, greys.of(kLight_hu));
        layers.light_cm2 =
            area_cm2 * static_cast<double>(layers.light_in_ct.size()) / static_cast<double>(samples.size());
    }
    layers.gap_cm2 = samples.empty() || !volume.is_hu ? 0 : area_cm2 * off / static_cast<double>(samples.size());
    return layers;
}

}  // namespace planlight
