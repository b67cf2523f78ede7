#include "segmentation/doubt_head.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "segmentation/cut_greys.h"
#include "segmentation/skin_doubts.h"

namespace planlight {
namespace {

constexpr double kLeastBall_mm = 40, kMostBall_mm = 100;  // newborn 45, adult with thick hair 85; a monkey's 38
constexpr double kFewLayers_refused = 0.2, kFewLayers_masked = 0.45, kFewLayers_doubted = 0.5;
constexpr double kFaintLayers = 0.85;  // of the vault: blurred averages show a faint layer all over, brains do not
constexpr double kBrightEnd = 0.05;    // of the head at exactly the greatest value: its bone is more
constexpr double kThinnestScalp_mm = 1.5;
constexpr double kFaintInBlur = 0.35, kNoBrain_mm = 72;  // an adult's brain holds a ball of 65 mm
constexpr double kBoneless_cm2 = 15;
constexpr double kNose_mm = 18;      // of an adult: noses stand out by 28 to 50; smaller heads in proportion
constexpr double kSureNose_mm = 28;  // of an adult, where it is sought elsewhere than in front
constexpr double kBeside_mm = 44;    // radius of a ball beside the head: a newborn's head holds one of 45, an arm of 40

const char* const kGiveHead =
    "Give the CT or MR series of the whole head as the scanner made it; for a phantom or a dry skull use `planlight "
    "prepare --phantom`.";

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

/// Why no scalp was found over bone, for the refusal.
SkinDoubt no_scalp(const Volume& volume, const SkinMask& mask, double layered_share) {
    const double bright = bright_end_share(volume, mask);
    if (bright > kBrightEnd)
        return {fmt::format("Whether scalp lies over bone cannot be told: {:.0f} % of the head show exactly the "
                            "greatest value, as where a CT was saved through a window for pictures, which makes "
                            "bone and all that is brighter one grey",
                            100 * bright),
                "Give the series in HU: its DICOM files, or converted without a window."};
    return {fmt::format("There is no scalp: only under {:.0f} % of the surface of the vault lies a layer of bone with "
                        "soft tissue over it (on heads 60 to 100 %); this is a stripped brain, a phantom or no head",
                        100 * layered_share),
            kGiveHead};
}

void judge_layers(const Volume& volume, const SkinMask& mask, bool air_is_blank, double faint_share, SkinJudgement& r) {
    const bool hu = volume.is_hu;
    if (std::isnan(r.layered_share))
        return add(r.doubts,
                   "Whether scalp lies over bone could not be asked: too little of the upper head is in the volume",
                   kLookAtTheSkin);
    if (r.boneless_cm2 > kBoneless_cm2)
        add(r.doubts,
            fmt::format(
                "Over {:.0f} square cm of the upper head no bone lies within 16 mm of the surface, though it does "
                "elsewhere: something that shines lies on the head there (a cushion, a blanket), or bone is "
                "missing",
                r.boneless_cm2),
            kLookAtTheSkin);
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
            kLookAtTheSkin);
    else if (r.layered_share < least)
        r.refusals.push_back(no_scalp(volume, mask, r.layered_share));
    else if (r.layered_share < kFewLayers_doubted && !r.bright_bone)
        add(r.doubts,
            fmt::format("Only under {:.0f} % of the surface of the vault was bone found under a scalp (on heads 60 to "
                        "100 %): parts of the scalp may be missing",
                        100 * r.layered_share),
            kLookAtTheSkin);
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

/// Whether the volume's end cuts more off above than below, as it does where a neck points up.
bool neck_may_be_above(const std::vector<CutSide>& ends) {
    double above_cm2 = 0, below_cm2 = 0;
    for (const CutSide& end : ends) {
        if (end.name == "crown") above_cm2 += end.area_cm2;
        if (end.name == "neck" || end.name == "chin") below_cm2 += end.area_cm2;
    }
    return below_cm2 == 0 || above_cm2 > below_cm2;
}

/// By the half turn after which a nose is in front. A mirror image of a head looks the same as some half turn of it. A
/// cushion or a mask may stand out as a nose does: upside down is no head whose neck is cut off below.
OtherwiseThanHeader nose_elsewhere(const TriangleMesh& skin, const HeadBall& ball, const std::vector<CutSide>& ends) {
    const std::pair<Eigen::Vector3d, const char*> turns[] = {
        {{-1, -1, 1}, "the head looks to the back"},
        {{1, -1, -1}, "the head is upside down and looks to the back"},
        {{-1, 1, -1}, "the head is upside down"}};
    OtherwiseThanHeader found;
    double best_mm = kSureNose_mm * std::min(1.0, ball.radius_mm / 72);
    for (const auto& [signs, words] : turns) {
        if (signs.z() < 0 && !neck_may_be_above(ends)) continue;
        TriangleMesh turned = skin;
        for (auto& p : turned.vertices_in_ct) p = ball.centre_in_ct + signs.cwiseProduct(p - ball.centre_in_ct);
        const double nose_mm = nose_length_mm(turned, ball, {ball.centre_in_ct});
        if (nose_mm > best_mm) best_mm = nose_mm, found = {words, nose_mm};
    }
    return found;
}

void judge_face(const TriangleMesh& skin, const HeadBall& ball, SkinJudgement& r) {
    if (!(r.nose_mm < nose_due_mm(r))) return;
    if (const OtherwiseThanHeader found = nose_elsewhere(skin, ball, r.cut_sides); !found.words.empty())
        return add(
            r.doubts,
            fmt::format("By its header {}, where a nose stands out by {:.0f} mm: the header does not say how the "
                        "head lies, and left and right may be exchanged as well",
                        found.words, found.nose_mm),
            "Convert the series again from DICOM, and compare the sides with what is known of the patient.");
    add(r.doubts,
        fmt::format("The face is not there: nothing stands out before the cheeks by more than {:.0f} mm where a nose "
                    "should (noses have 25 to 50 mm); it was taken away, covered or cut off, or the head is bent back "
                    "or forward",
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

}  // namespace

void doubt_head(const Volume& volume, const SkinMask& mask, const TriangleMesh& skin, const HeadBall& ball,
                const MiddlePlane& plane, const SkinLayers& layers, SkinJudgement& judgement) {
    judge_size(judgement);
    judge_proportions(skin, ball, plane, judgement);
    judge_layers(volume, mask, layers.faint_share < kFaintLayers && layers.air_is_blank, layers.faint_share, judgement);
    judge_face(skin, ball, judgement);
    judge_beside(judgement);
}

}  // namespace planlight
