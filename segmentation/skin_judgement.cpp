#include "segmentation/skin_judgement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "planning_io/types/error.h"
#include "segmentation/beside_head.h"
#include "segmentation/boneless_ends.h"
#include "segmentation/head_proportions.h"
#include "segmentation/series_doubts.h"
#include "segmentation/skin_layers.h"
#include "segmentation/skin_shape.h"
#include "segmentation/skin_threshold.h"
#include "segmentation/slice_steps.h"
#include "segmentation/things_on_skin.h"

namespace planlight {
namespace {

constexpr double kLeastBall_mm = 40, kMostBall_mm = 100;  // newborn 45, adult with thick hair 85; a monkey's 38
constexpr double kFewLayers_refused = 0.2, kFewLayers_masked = 0.45, kFewLayers_doubted = 0.5;
constexpr double kFaintLayers = 0.85;  // of the vault: blurred averages show a faint layer all over, brains do not
constexpr double kThinnestScalp_mm = 1.5;
constexpr double kNose_mm = 18;      // of an adult: noses stand out by 28 to 50; smaller heads in proportion
constexpr double kBeside_mm = 44;    // radius of a ball beside the head: a newborn's head holds one of 45, an arm of 40
constexpr double kSureNose_mm = 28;  // of an adult, where it is sought elsewhere than in front
constexpr double kBlurred_mm = 4.2;
constexpr double kThick_mm = 3.5;  // thicker slices than that leave more than 1 % of the skin over 2 mm off
constexpr double kUnsure_doubted = 0.06, kUnsure_refused = 0.3;
constexpr double kFaintInBlur = 0.35, kNoBrain_mm = 72;  // an adult's brain holds a ball of 65 mm
constexpr double kStrand_mm = 75;                        // ears, lips and fins of noise lead away by 50
constexpr double kBoneless_cm2 = 15;
constexpr double kGap_cm2 = 15, kLight_cm2 = 15;
constexpr double kBonelessEnd_cm2 = 8;  // an ear that the volume cuts off has 4
constexpr double kOneSided_cm2 = 15, kBumps_cm2 = 10, kShelf_cm2 = 15, kWidth = 1.35, kThickest_mm = 15;

// `measure_mr_draws 1 4 0.8 --skin 0 --noise 0.02 --fat-shift MM`: fat up to the surface moved by 1 and 2 mm moves the
// skin by 0.45 of it (rms), and at 2 mm more than 1 % of the skin by over 2 mm; under skin of 1.5 mm less.
constexpr double kSkinOfFatShift = 0.45, kFatShift_mm = 1.5;

// Of 500 draws of `measure_mr_draws` and 23 real heads the noisiest that is right has 0.57.
constexpr double kNoisy_mm = 0.75;

const char* const kGiveHead =
    "Give the CT or MR series of the whole head as the scanner made it; for a phantom or a dry skull use `planlight "
    "prepare --phantom`.";
const char* const kLook = "Look at the skin in the report before you use it.";

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

/// What a nose of so large a head stands out by at least.
double nose_due_mm(const SkinJudgement& r) {
    return kNose_mm * std::min(1.0, r.ball_radius_mm / 72);
}

/// A head that looks aside by a quarter of a turn is broader along the patient's left and right than it is long.
bool looks_ahead(const HeadProportions& found, const MiddlePlane& plane, const SkinJudgement& r) {
    constexpr double kAside = 0.26;  // 15 degrees
    const bool nose_ahead = std::isnan(r.nose_mm) || r.nose_mm >= nose_due_mm(r);
    const bool mirrored = !(r.one_sided_cm2 > kOneSided_cm2);  // left and right are alike
    return nose_ahead && mirrored && std::abs(found.turn) < kAside && !plane.looks_aside();
}

void judge_proportions(const TriangleMesh& skin, const HeadBall& ball, const MiddlePlane& plane, SkinJudgement& r) {
    constexpr double kNarrow = 0.62, kBroad = 1.03, kLow = 0.65, kHigh = 1.2;
    const auto found = head_proportions(skin, ball);
    if (!found) return;
    r.breadth_of_length = found->breadth_of_length;
    r.height_of_width = found->height_of_width.value_or(0);
    const std::string remedy =
        "Compare the voxel size in the file with what the scanner was set to; convert the series again from DICOM.";
    const bool ahead = looks_ahead(*found, plane, r);
    const double narrow =
        ahead ? found->breadth_of_length : std::min(found->breadth_of_length, 1 / found->breadth_of_length);
    if (narrow < kNarrow || (ahead && found->breadth_of_length > kBroad))
        add(r.doubts,
            fmt::format("The head is {:.0f} mm broad and {:.0f} mm long, which few heads are: it is misshapen, or the "
                        "size of the voxels in the file may be wrong",
                        found->breadth_mm, found->length_mm),
            remedy);
    else if (found->height_of_width && (*found->height_of_width < kLow || *found->height_of_width > kHigh))
        add(r.doubts,
            fmt::format("The crown is {} for a head {:.0f} mm broad and {:.0f} mm long ({:.2f}; heads have 0.8 to "
                        "1.1): the distance of the slices in the file may be wrong",
                        *found->height_of_width < kLow ? "low" : "high", found->breadth_mm, found->length_mm,
                        *found->height_of_width),
            remedy);
}

void judge_layers(const Volume& volume, bool air_is_blank, double faint_share, SkinJudgement& r) {
    const bool hu = volume.is_hu;
    if (std::isnan(r.layered_share))
        return add(r.doubts,
                   "Whether scalp lies over bone could not be asked: too little of the upper head is in the volume",
                   kLook);
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

/// How a head lies whose nose is not in front: in words, empty where no nose is found elsewhere.
struct OtherwiseThanHeader {
    std::string words;
    double nose_mm = 0;
};

/// By the half turn after which a nose is in front. A mirror image of a head looks the same as some half turn of it.
OtherwiseThanHeader nose_elsewhere(const TriangleMesh& skin, const HeadBall& ball) {
    const std::pair<Eigen::Vector3d, const char*> turns[] = {
        {{-1, -1, 1}, "the head looks to the back"},
        {{1, -1, -1}, "the head is upside down and looks to the back"},
        {{-1, 1, -1}, "the head is upside down"}};
    OtherwiseThanHeader found;
    double best_mm = kSureNose_mm * std::min(1.0, ball.radius_mm / 72);
    for (const auto& [signs, words] : turns) {
        TriangleMesh turned = skin;
        for (auto& p : turned.vertices_in_ct) p = ball.centre_in_ct + signs.cwiseProduct(p - ball.centre_in_ct);
        const double nose_mm = nose_length_mm(turned, ball, {ball.centre_in_ct});
        if (nose_mm > best_mm) best_mm = nose_mm, found = {words, nose_mm};
    }
    return found;
}

void judge_face(const TriangleMesh& skin, const HeadBall& ball, SkinJudgement& r) {
    if (!(r.nose_mm < nose_due_mm(r))) return;
    if (const OtherwiseThanHeader found = nose_elsewhere(skin, ball); !found.words.empty())
        return add(
            r.doubts,
            fmt::format("By its header {}, where a nose stands out by {:.0f} mm: the header does not say how the "
                        "head lies, and left and right may be exchanged as well",
                        found.words, found.nose_mm),
            "Convert the series again from DICOM, and compare the sides with what is known of the patient.");
    add(r.doubts,
        fmt::format("The face is not there: nothing stands out before the cheeks by more than {:.0f} mm where a nose "
                    "should (noses have 25 to 50 mm); it was taken away, covered or cut off",
                    r.nose_mm),
        "Give the series as the scanner made it: the scan is matched by the face.");
}

void judge_beside(SkinJudgement& r) {
    if (r.beside_mm < kBeside_mm) return;
    add(r.doubts,
        fmt::format("Beside the head that was taken lies something as thick as a head (a ball of {:.0f} mm fits in): "
                    "the volume may show two heads, or the head and a phantom",
                    r.beside_mm),
        "Give a series of this patient alone, and look which of them is in the report.");
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
    if (r.light_cm2 > kLight_cm2)
        add(r.doubts,
            fmt::format("Over {:.0f} square cm ({}) what lies just under the surface is lighter than skin and "
                        "fat: hair, a strap, a cloth or a cover lies on the skin there",
                        r.light_cm2, r.light_at.empty() ? "all over the head" : "most at " + r.light_at),
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
        "times what was found ({})",
        100 * mask.unsure_share, threshold_text(mask.threshold_said));
    const std::string tries =
        fmt::format("Try `planlight prepare --threshold {}` and {}, and compare the pictures of the report.",
                    threshold_text(0.7 * mask.threshold_said), threshold_text(1.5 * mask.threshold_said));
    r.unsure = mask.unsure_share > kUnsure_doubted;
    if (mask.unsure_share > kUnsure_refused)
        add(r.refusals, "The skin cannot be told from what surrounds it: " + unsure, tries);
    else if (mask.unsure_share > kUnsure_doubted)
        add(r.doubts, "The skin is uncertain in places: " + unsure, tries);
}

void judge_things(SkinJudgement& r) {
    std::string unasked;
    for (const auto& [figure, what] :
         {std::pair{r.one_sided_cm2, "at one side"}, {r.bumps_cm2, "small things"}, {r.width, "at both sides"}})
        if (std::isnan(figure)) unasked += (unasked.empty() ? "" : ", ") + std::string(what);
    if (!unasked.empty())
        add(r.doubts,
            fmt::format("Whether something lies on the skin ({}) could not be asked: too little of the head is in "
                        "the volume",
                        unasked),
            kLook);
    if (r.one_sided_cm2 > kOneSided_cm2)
        add(r.doubts,
            fmt::format("Over {:.0f} square cm one side of the head stands out by more than 10 mm before the other: "
                        "something lies on the skin there (a cushion, a cloth), or the head itself is not symmetric",
                        r.one_sided_cm2),
            kLook);
    if (r.bumps_cm2 > kBumps_cm2)
        add(r.doubts,
            fmt::format("Small things stand out from the upper head over {:.0f} square cm (electrodes, a bandage, a "
                        "strap, a mask): there the surface is not the skin",
                        r.bumps_cm2),
            kLook);
    if (r.shelf_cm2 > kShelf_cm2)
        add(r.doubts,
            fmt::format(
                "Behind the neck {:.0f} square cm of the surface look up, where a head recedes: something may lie "
                "under the neck (a cushion, a roll)",
                r.shelf_cm2),
            kLook);
    if (r.width > kWidth)
        add(r.doubts,
            fmt::format("At ears or jaw the head is {:.1f} times as wide as its skull (heads are 0.9 to 1.2 times): "
                        "something may lie on the skin at both sides (head phones, cushions)",
                        r.width),
            kLook);
    if (r.scalp_mm > kThickest_mm)
        add(r.doubts,
            fmt::format("The soft tissue over the bone of the upper head is {:.0f} mm thick (on heads 4 to 14): "
                        "something may lie on it all over (a cap, wet hair)",
                        r.scalp_mm),
            kLook);
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

void judge_movement(const Volume& volume, const SkinMask& mask, const HeadBall& ball, SkinJudgement& r) {
    const auto step = largest_slice_step(volume, mask, ball);
    if (!step) return;
    r.slice_jump_mm = step->jump_mm;
    Eigen::Index across = 0;
    step->normal_in_ct.cwiseAbs().maxCoeff(&across);
    add(r.doubts,
        fmt::format("Between two slices across {}, at {:.0f} mm, the whole outline jumps: what follows is shifted by "
                    "{:.1f} mm and turned by {:.1f} degrees. The patient seems to have moved while the series was "
                    "taken, and the skin of one side of that place does not fit the other",
                    way_in_words(step->normal_in_ct), step->place_in_ct[across], step->shift_mm,
                    std::abs(step->turn) * 180 / std::numbers::pi),
        "Give a series in which the patient lay still; look at the skin in the report.");
}

void judge_fat_shift(const Volume& volume, SkinJudgement& r) {
    r.fat_shift_mm = volume.fat_shift_in_ct.norm();
    if (!(r.fat_shift_mm > 0)) return;
    r.fat_shift_along = way_in_words(volume.fat_shift_in_ct);
    r.sigma_mm = std::hypot(r.sigma_mm, kSkinOfFatShift * r.fat_shift_mm);
    if (r.fat_shift_mm < kFatShift_mm) return;
    add(r.doubts,
        fmt::format("By its bandwidth the scanner drew fat {:.1f} mm aside, along {} (chemical shift): where fat lies "
                    "close under the skin, the surface may be off by as much",
                    r.fat_shift_mm, r.fat_shift_along),
        "Use a series of higher bandwidth or with fat suppression if there is one, and look at the skin in the "
        "report.");
}

void judge_noise(SkinJudgement& r) {
    if (r.noise_sigma_mm < kNoisy_mm) return;
    add(r.doubts,
        fmt::format(
            "Noise alone moves the skin by {:.1f} mm (one sigma; on usual heads less than 0.6): it may lie off by "
            "2 mm and more, and too deep where thin skin drowns in it",
            r.noise_sigma_mm),
        "Use a series with less noise if there is one, and look at the skin in the report.");
}

void judge_greys(const CtGreys& greys, SkinJudgement& r) {
    if (greys.usual) return;
    add(r.doubts,
        fmt::format(
            "The greys of this CT are not quite HU, as a cone-beam CT's are: soft tissue lies at {:.0f} and not "
            "near 35. Bone was looked for at {:.0f} and above",
            greys.soft, greys.of(300)),
        kLook);
}

void judge_cuts(SkinJudgement& r) {
    std::string sides;
    int count = 0;
    for (const CutSide& side : r.cut_sides)
        if (!side.usual) {
            sides += fmt::format("{}the {} ({:.0f} square cm)", count == 0 ? "" : ", ", side.name, side.area_cm2);
            ++count;
        }
    for (const CutSide& side : r.cut_sides)
        if (side.boneless_cm2 > kBonelessEnd_cm2)
            add(r.doubts,
                fmt::format("At {} the volume ends over {:.0f} square cm within something that has no bone under it "
                            "nor round it: something lies on the head there (a cushion, wet hair, a blanket)",
                            "the " + side.name, side.boneless_cm2),
                kLook);
    if (count > 0)
        add(r.doubts, fmt::format("The volume ends within the head: it cuts off {}; what lies there is no skin", sides),
            "Scan, match and draw elsewhere, or give a series that shows the whole head.");
}

}  // namespace

SkinJudgement judge_skin(const Volume& volume, const SkinMask& mask, const TriangleMesh& skin) {
    SkinJudgement result;
    if (skin.vertices_in_ct.empty()) return result;
    const HeadBall ball = largest_ball(volume, mask, skin);
    result.ball_radius_mm = ball.radius_mm;
    result.ball_centre_in_ct = ball.centre_in_ct;
    const CtGreys greys = ct_greys(volume, mask);
    result.cut_sides = cut_sides_of(skin, ball, boneless_ends(volume, mask, skin, ball, greys));
    const ThingsOnSkin things = things_on_skin(volume, mask, skin, ball);
    const SkinLayers layers = layers_under(volume, mask, skin, result.ball_centre_in_ct, things.plane, greys);
    result.layered_share = layers.layered_share;
    result.scalp_mm = layers.scalp_mm;
    result.edge_blur_mm = layers.edge_blur_mm;
    result.gap_cm2 = layers.gap_cm2;
    result.boneless_cm2 = layers.boneless_cm2;
    result.light_cm2 = layers.light_cm2;
    result.light_at = where_on_head(layers.light_in_ct, ball);
    result.beside_mm = ball_beside_head_mm(volume, mask);
    if (!mask.levels.empty()) result.strand_mm = strand_length_mm(volume, mask, skin);
    result.nose_mm = nose_length_mm(skin, ball, things.plane);
    result.one_sided_cm2 = things.one_sided_cm2;
    result.bumps_cm2 = things.bumps_cm2;
    result.width = things.width;
    result.shelf_cm2 = things.shelf_cm2;
    result.bright_bone = layers.bright_bone;
    result.noise_sigma_mm = skin_edge_sigma_mm(volume, mask, skin);
    result.sigma_mm = std::max(result.noise_sigma_mm, 0.25 * std::max(0.0, result.edge_blur_mm - 1.5));
    judge_size(result);
    judge_proportions(skin, ball, things.plane, result);
    judge_layers(volume, layers.faint_share < kFaintLayers && layers.air_is_blank, layers.faint_share, result);
    judge_face(skin, ball, result);
    judge_beside(result);
    judge_edges(mask, result);
    judge_things(result);
    judge_greys(greys, result);
    judge_noise(result);
    judge_fat_shift(volume, result);
    judge_steps(volume, result);
    judge_movement(volume, mask, ball, result);
    doubt_series(volume, mask, result);
    judge_cuts(result);
    return result;
}

void refuse_implausible(const SkinJudgement& judgement) {
    if (judgement.refusals.empty()) return;
    throw InputError({}, judgement.refusals.front().finding, judgement.refusals.front().remedy);
}

}  // namespace planlight
