#include "segmentation/skin_judgement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "planning_io/types/error.h"
#include "planning_io/types/statistics.h"
#include "segmentation/head_survey.h"
#include "segmentation/skin_layers.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr double kGrid_mm = 4;                            // of the ball's search
constexpr double kUpperHead_mm = 150;                     // under the crown: the ball is the skull's, not the chest's
constexpr double kLeastBall_mm = 40, kMostBall_mm = 100;  // newborn 45, adult with thick hair 85; a monkey's 38
constexpr double kFewLayers_refused = 0.2, kFewLayers_masked = 0.45, kFewLayers_doubted = 0.5;
constexpr double kFaintLayers = 0.85;  // of the vault: blurred averages show a faint layer all over, brains do not
constexpr double kThinnestScalp_mm = 1.5;
constexpr double kNose_mm = 18;  // of an adult: noses stand out by 28 to 50; smaller heads in proportion
constexpr double kBlurred_mm = 4.2;
constexpr double kThick_mm = 3.5;  // thicker slices than that leave more than 1 % of the skin over 2 mm off
constexpr double kUnsure_doubted = 0.06, kUnsure_refused = 0.3;
constexpr double kFaintInBlur = 0.35, kNoBrain_mm = 72;  // an adult's brain holds a ball of 65 mm
constexpr double kStrand_mm = 75;                        // ears, lips and fins of noise lead away by 50
constexpr double kBoneless_cm2 = 15;
constexpr double kGap_cm2 = 15, kLeastCut_cm2 = 1;

const char* const kGiveHead =
    "Give the CT or MR series of the whole head as the scanner made it; for a phantom or a dry skull use `planlight "
    "prepare --phantom`.";
const char* const kLook = "Look at the skin in the report before you use it.";

double area_of(const TriangleMesh& mesh, const std::array<std::int32_t, 3>& t, Vector3d* normal) {
    const auto& a = mesh.vertices_in_ct[static_cast<std::size_t>(t[0])];
    const Vector3d n = (mesh.vertices_in_ct[static_cast<std::size_t>(t[1])] - a)
                           .cross(mesh.vertices_in_ct[static_cast<std::size_t>(t[2])] - a);
    *normal = n.normalized();
    return n.norm() / 2;
}

/// The largest ball in the upper head. What the volume does not show is taken for body: it does not make a ball small.
void find_ball(const Volume& volume, const SkinMask& mask, const TriangleMesh& skin, SkinJudgement& result) {
    Vector3d low = skin.vertices_in_ct.front(), high = low;
    for (const auto& p : skin.vertices_in_ct) low = low.cwiseMin(p), high = high.cwiseMax(p);
    HeadSurvey survey;
    survey.grid.spacing_mm = Vector3d::Constant(kGrid_mm);
    survey.first_in_ct = low - Vector3d::Constant(kGrid_mm);
    for (int a = 0; a < 3; ++a)
        survey.grid.size[static_cast<std::size_t>(a)] = static_cast<int>((high - low)[a] / kGrid_mm) + 3;
    Mask body(survey.grid.count(), 1);
    const Eigen::Affine3d voxel_from_ct = volume.ct_from_voxel.inverse();
    for (std::size_t v = 0; v < body.size(); ++v) {
        const Eigen::Vector3i at = (voxel_from_ct * survey.place_of(v)).array().round().cast<int>();
        bool inside = true;
        for (int a = 0; a < 3; ++a) inside = inside && at[a] >= 0 && at[a] < volume.size[static_cast<std::size_t>(a)];
        if (inside) body[v] = mask.body[volume.index(at.x(), at.y(), at.z())];
    }
    const auto depth = distance_from(body, 0, survey.grid, kMostBall_mm + 30);
    for (std::size_t v = 0; v < body.size(); ++v) {
        const Vector3d at = survey.place_of(v);
        if (high.z() - at.z() > kUpperHead_mm || static_cast<double>(depth[v]) <= result.ball_radius_mm) continue;
        if (((at - low).array() < 0).any() || ((high - at).array() < 0).any()) continue;
        result.ball_radius_mm = static_cast<double>(depth[v]);
        result.ball_centre_in_ct = at;
    }
}

/// How far a thin thing that hangs on an MR's head (a strap, a wire) leads away from it, mm along itself; an ear's rim
/// 50 mm at most. Steps along the axes, so that a way aslant is longer than it is.
double strand_of(const Volume& volume, const SkinMask& mask, const TriangleMesh& skin) {
    constexpr double kStep_mm = 3, kThin_mm = 7, kMost_mm = 300;
    Vector3d low = skin.vertices_in_ct.front(), high = low;
    for (const auto& p : skin.vertices_in_ct) low = low.cwiseMin(p), high = high.cwiseMax(p);
    HeadSurvey survey;
    survey.grid.spacing_mm = Vector3d::Constant(kStep_mm);
    survey.first_in_ct = low - Vector3d::Constant(kStep_mm);
    for (int a = 0; a < 3; ++a)
        survey.grid.size[static_cast<std::size_t>(a)] = static_cast<int>((high - low)[a] / kStep_mm) + 3;
    Mask body(survey.grid.count(), 0);
    const Eigen::Affine3d voxel_from_ct = volume.ct_from_voxel.inverse();
    for (std::size_t v = 0; v < body.size(); ++v) {
        const Eigen::Vector3i at = (voxel_from_ct * survey.place_of(v)).array().round().cast<int>();
        bool inside = true;
        for (int a = 0; a < 3; ++a) inside = inside && at[a] >= 0 && at[a] < volume.size[static_cast<std::size_t>(a)];
        if (inside) body[v] = mask.body[volume.index(at.x(), at.y(), at.z())];
    }
    const auto depth = distance_from(body, 0, survey.grid, kThin_mm + kStep_mm);
    Mask core(body.size());
    for (std::size_t v = 0; v < core.size(); ++v) core[v] = static_cast<double>(depth[v]) > kThin_mm;
    core = largest_piece(std::move(core), survey.grid).mask;
    const auto from_core = distance_from(core, 1, survey.grid, kThin_mm + 2 * kStep_mm);
    std::vector<std::size_t> front;
    for (std::size_t v = 0; v < body.size(); ++v)
        if (body[v] && static_cast<double>(from_core[v]) < kThin_mm + kStep_mm) front.push_back(v), body[v] = 0;
    double reached_mm = 0;
    for (double way_mm = kStep_mm; !front.empty() && way_mm < kMost_mm; way_mm += kStep_mm) {
        std::vector<std::size_t> next;
        for (const std::size_t v : front)
            for_face_neighbours(survey.grid, v, [&](std::size_t n) {
                if (body[n]) body[n] = 0, next.push_back(n);
            });
        if (!next.empty()) reached_mm = way_mm;
        front = std::move(next);
    }
    return reached_mm;
}

void find_cut_sides(const TriangleMesh& skin, SkinJudgement& result) {
    if (skin.flags.empty()) return;
    std::map<std::string, CutSide> sides;
    for (const auto& t : skin.triangles) {
        bool cut = true;
        for (const auto c : t) cut = cut && skin.flags[static_cast<std::size_t>(c)] == kCutPlane;
        if (!cut) continue;
        Vector3d normal;
        const double cm2 = area_of(skin, t, &normal) / 100;
        int axis = 0;
        normal.cwiseAbs().maxCoeff(&axis);
        const bool up = normal[axis] > 0;
        const double below_mm = result.ball_centre_in_ct.z() - skin.vertices_in_ct[static_cast<std::size_t>(t[0])].z();
        const bool under_chin =
            below_mm > 1.5 * std::min(result.ball_radius_mm, 75.0);  // an adult's chin lies 110 to 140 mm below
        const char* name = axis == 0    ? (up ? "left side" : "right side")
                           : axis == 1  ? (up ? "back" : "face")
                           : up         ? "crown"
                           : under_chin ? "neck"
                                        : "chin";
        CutSide& side = sides[name];
        side.name = name;
        side.area_cm2 += cm2;
        // Shoulders and neck end at every side of a volume; below the chin that is usual.
        side.usual = side.name == "neck";
        if (axis != 2 && below_mm > 1.3 * std::min(result.ball_radius_mm, 75.0))
            sides[name].area_cm2 -= cm2, sides["neck"].area_cm2 += cm2, sides["neck"].name = "neck",
                                                                        sides["neck"].usual = true;
    }
    for (const auto& [name, side] : sides)
        if (side.area_cm2 > kLeastCut_cm2) result.cut_sides.push_back(side);
}

/// How far a nose stands out before the cheeks, at the height where it does most; not a number where the volume ends
/// above it or no front is in it.
double nose_of(const TriangleMesh& skin, const SkinJudgement& result) {
    constexpr double kCell_mm = 4, kSteep = 0.4;
    const Vector3d c = result.ball_centre_in_ct;
    const double r = result.ball_radius_mm, scale = r / 72;
    std::map<std::pair<int, int>, double> front;  // least y (to the front) of each cell of x and z
    double lowest = c.z(), x_sum = 0, x_count = 0;
    for (const auto& p : skin.vertices_in_ct) {
        if (p.z() > c.z() && p.y() < c.y()) x_sum += p.x(), x_count += 1;
        lowest = std::min(lowest, p.z());
        if (p.y() > c.y() || std::abs(p.x() - c.x()) > 1.2 * r) continue;
        const std::pair<int, int> cell(static_cast<int>(std::floor(p.x() / kCell_mm)),
                                       static_cast<int>(std::floor(p.z() / kCell_mm)));
        const auto [at, fresh] = front.emplace(cell, p.y());
        if (!fresh) at->second = std::min(at->second, p.y());
    }
    if (x_count == 0 || c.z() - lowest < 0.75 * r) return NAN;
    const double middle = x_sum / x_count;
    const auto front_at = [&](double from, double to, int z) {
        std::vector<double> ys;
        for (int x = static_cast<int>(std::floor(from / kCell_mm)); x <= static_cast<int>(std::floor(to / kCell_mm));
             ++x)
            if (const auto at = front.find({x, z}); at != front.end()) ys.push_back(at->second);
        return ys;
    };
    double best = 0;
    for (int z = static_cast<int>(std::floor((c.z() - 1.6 * r) / kCell_mm));
         z <= static_cast<int>(std::floor((c.z() - 0.2 * r) / kCell_mm)); ++z)
        for (double aside = -16; aside <= 16; aside += 4) {  // a head may lie askew
            const double x = middle + aside;
            const auto ridge = front_at(x - 6 * scale, x + 6 * scale, z),
                       left = front_at(x + 24 * scale, x + 36 * scale, z),
                       right = front_at(x - 36 * scale, x - 24 * scale, z);
            if (ridge.empty() || left.empty() || right.empty()) continue;
            const double tip = *std::min_element(ridge.begin(), ridge.end());
            const double out_mm = std::min(median(left), median(right)) - tip;
            // A nose is steep beside its ridge; a round chin or crown falls away a quarter as much half as far out.
            const auto near_left = front_at(x + 12 * scale, x + 18 * scale, z),
                       near_right = front_at(x - 18 * scale, x - 12 * scale, z);
            if (near_left.empty() || near_right.empty()) continue;
            if (std::min(median(near_left), median(near_right)) - tip < kSteep * out_mm) continue;
            best = std::max(best, out_mm);
        }
    return best;
}

void add(std::vector<SkinDoubt>& list, std::string finding, std::string remedy) {
    list.push_back({std::move(finding), std::move(remedy)});
}

void judge_size(SkinJudgement& r) {
    if (r.ball_radius_mm < kLeastBall_mm)
        add(r.refusals,
            fmt::format("What was found is no human head: the largest ball within it has a radius of {:.0f} mm "
                        "(a newborn's head holds one of 45 mm)",
                        r.ball_radius_mm),
            kGiveHead);
    if (r.ball_radius_mm > kMostBall_mm)
        add(r.refusals,
            fmt::format("What was found is no head: the largest ball within it has a radius of {:.0f} mm (a head "
                        "holds one of 60 to 85 mm)",
                        r.ball_radius_mm),
            kGiveHead);
}

void judge_layers(const Volume& volume, bool air_is_blank, double faint_share, SkinJudgement& r) {
    const bool hu = volume.is_hu;
    if (std::isnan(r.layered_share)) return;
    if (r.boneless_cm2 > kBoneless_cm2)
        add(r.doubts,
            fmt::format(
                "Over {:.0f} square cm of the upper head no bone lies within 16 mm of the surface, though it does "
                "elsewhere: something that shines lies on the head there (a cushion, a blanket), or bone is "
                "missing",
                r.boneless_cm2),
            kLook);
    // Where a program blanked everything round a brain, not even a part of the layers is a head's.
    const double least = air_is_blank ? kFewLayers_masked : kFewLayers_refused;
    // A blurred average of heads hides its bone; but nothing of that size is a brain, and a bottle has no layer at all.
    if (r.layered_share < least && !air_is_blank && faint_share > kFaintInBlur && r.edge_blur_mm > kBlurred_mm &&
        r.ball_radius_mm > kNoBrain_mm)
        add(r.doubts,
            fmt::format(
                "Scalp and bone can hardly be told apart: the volume is blurred, and only under {:.0f} % of the "
                "surface of the vault is bone as dark as on heads (60 to 100 %)",
                100 * r.layered_share),
            kLook);
    else if (r.layered_share < least)
        add(r.refusals,
            fmt::format("There is no scalp: only under {:.0f} % of the surface of the vault lies a layer of bone with "
                        "soft tissue over it (on heads 60 to 100 %); this is a stripped brain, a phantom or no head",
                        100 * r.layered_share),
            kGiveHead);
    else if (r.layered_share < kFewLayers_doubted && !r.bright_bone)
        add(r.doubts,
            fmt::format("Only under {:.0f} % of the surface of the vault was bone found under a scalp (on heads 60 to "
                        "100 %): parts of the scalp may be missing",
                        100 * r.layered_share),
            kLook);
    if (hu && r.layered_share >= least && r.scalp_mm < kThinnestScalp_mm)
        add(r.refusals,
            fmt::format("There is no soft tissue over the bone ({:.1f} mm): this is a dry skull or a phantom",
                        r.scalp_mm),
            kGiveHead);
    if (r.bright_bone)
        add(r.doubts,
            "The bone is brighter than all else, as in a CT, but the values are not HU: the skin was found from their "
            "contrast",
            "Give the series in HU if there is one, and look at the skin in the report.");
}

void judge_face(SkinJudgement& r) {
    if (!(r.nose_mm < kNose_mm * std::min(1.0, r.ball_radius_mm / 72))) return;
    add(r.doubts,
        fmt::format("The face is not there: nothing stands out before the cheeks by more than {:.0f} mm where a nose "
                    "should (noses have 25 to 50 mm); it was taken away, covered or cut off",
                    r.nose_mm),
        "Give the series as the scanner made it: the scan is matched by the face.");
}

void judge_edges(const SkinMask& mask, SkinJudgement& r) {
    if (r.edge_blur_mm > kBlurred_mm)
        add(r.doubts,
            fmt::format("The edge of the skin is blurred over {:.1f} mm: where it lies is uncertain by {:.1f} mm",
                        r.edge_blur_mm, r.sigma_mm),
            "Use a sharper series if there is one.");
    if (r.gap_cm2 > kGap_cm2)
        add(r.doubts,
            fmt::format(
                "Something thin lies on the skin or stands off it over {:.0f} square cm (a mask, a cushion, a cloth): "
                "there the surface is not the skin",
                r.gap_cm2),
            kLook);
    if (r.strand_mm > kStrand_mm)
        add(r.doubts,
            fmt::format(
                "Something thin hangs on the head and leads {:.0f} mm away along itself (a strap, a wire, a strip "
                "beside an ear): there the surface is not the skin",
                r.strand_mm),
            kLook);
    const std::string unsure = fmt::format(
        "{:.0f} % of the outline moves by more than 3 mm when the threshold is taken at 0.7 or 1.5 "
        "times what was found ({:.3g})",
        100 * mask.unsure_share, mask.threshold_said);
    const std::string tries =
        fmt::format("Try `planlight prepare --threshold {:.3g}` and {:.3g}, and compare the pictures of the report.",
                    0.7 * mask.threshold_said, 1.5 * mask.threshold_said);
    r.unsure = mask.unsure_share > kUnsure_doubted;
    if (mask.unsure_share > kUnsure_refused)
        add(r.refusals, "The skin cannot be told from what surrounds it: " + unsure, tries);
    else if (mask.unsure_share > kUnsure_doubted)
        add(r.doubts, "The skin is uncertain in places: " + unsure, tries);
}

void judge_steps(const Volume& volume, SkinJudgement& r) {
    const double step_mm = volume.spacing_mm().maxCoeff();
    if (step_mm < kThick_mm) return;
    r.sigma_mm = std::max(r.sigma_mm, step_mm / 6);
    add(r.doubts,
        fmt::format("The slices lie {:.1f} mm apart: between them the skin is guessed, and uncertain by {:.1f} mm",
                    step_mm, r.sigma_mm),
        "Use a series of thinner slices if there is one.");
}

void judge_cuts(SkinJudgement& r) {
    for (const CutSide& side : r.cut_sides)
        if (!side.usual)
            add(r.doubts,
                fmt::format(
                    "The volume ends within the head: the {} is cut off over {:.0f} square cm, which is no skin",
                    side.name, side.area_cm2),
                "Scan, match and draw elsewhere, or give a series that shows the whole head.");
}

}  // namespace

SkinJudgement judge_skin(const Volume& volume, const SkinMask& mask, const TriangleMesh& skin) {
    SkinJudgement result;
    if (skin.vertices_in_ct.empty()) return result;
    find_ball(volume, mask, skin, result);
    find_cut_sides(skin, result);
    result.nose_mm = nose_of(skin, result);
    const SkinLayers layers = layers_under(volume, mask, skin, result.ball_centre_in_ct);
    result.layered_share = layers.layered_share;
    result.scalp_mm = layers.scalp_mm;
    result.edge_blur_mm = layers.edge_blur_mm;
    result.gap_cm2 = layers.gap_cm2;
    result.boneless_cm2 = layers.boneless_cm2;
    if (!mask.levels.empty()) result.strand_mm = strand_of(volume, mask, skin);
    result.bright_bone = layers.bright_bone;
    result.sigma_mm = std::max(skin_edge_sigma_mm(volume, mask, skin), 0.25 * std::max(0.0, result.edge_blur_mm - 1.5));
    judge_size(result);
    judge_layers(volume, layers.faint_share < kFaintLayers && layers.air_is_blank, layers.faint_share, result);
    judge_face(result);
    judge_edges(mask, result);
    judge_steps(volume, result);
    judge_cuts(result);
    return result;
}

void refuse_implausible(const SkinJudgement& judgement) {
    if (judgement.refusals.empty()) return;
    throw InputError({}, judgement.refusals.front().finding, judgement.refusals.front().remedy);
}

}  // namespace planlight
