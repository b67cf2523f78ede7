#include "segmentation/doubt_series.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "segmentation/cut_greys.h"
#include "segmentation/series_echo.h"
#include "segmentation/skin_doubts.h"
#include "segmentation/slice_steps.h"

namespace planlight {
namespace {

constexpr double kThick_mm = 3.5;  // thicker slices than that leave more than 1 % of the skin over 2 mm off

// `measure_mr_draws 1 4 0.8 --skin 0 --noise 0.02 --fat-shift MM`: fat up to the surface moved by 1 and 2 mm moves the
// skin by 0.45 of it (rms), and at 2 mm more than 1 % of the skin by over 2 mm; under skin of 1.5 mm less.
constexpr double kSkinOfFatShift = 0.45, kFatShift_mm = 1.5;

// Of 500 draws of `measure_mr_draws` and 23 real heads the noisiest that is right has 0.57.
constexpr double kNoisy_mm = 0.75;

void judge_greys(const CtGreys& greys, SkinJudgement& r) {
    if (greys.usual) return;
    add(r.doubts,
        fmt::format(
            "The greys of this CT are not quite HU, as a cone-beam CT's are: soft tissue lies at {:.0f} and not "
            "near 35. Bone was looked for at {:.0f} and above",
            greys.soft, greys.of(300)),
        kLookAtTheSkin);
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

void judge_steps(const Volume& volume, SkinJudgement& r) {
    const double step_mm = std::max(volume.spacing_mm().maxCoeff(), volume.widest_gap_mm);
    if (step_mm < kThick_mm) return;
    r.sigma_mm = std::max(r.sigma_mm, step_mm / 6);
    add(r.doubts,
        fmt::format("The slices lie {}{:.1f} mm apart: between them the skin is guessed, and uncertain by {:.1f} mm",
                    volume.widest_gap_mm > 0 ? "up to " : "", step_mm, r.sigma_mm),
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

void judge_cut_greys(const Volume& volume, const SkinMask& mask, SkinJudgement& r) {
    const CutGreys cut = cut_greys(volume, mask);
    r.cut_air_share = cut.air_share;
    r.cut_body_share = cut.body_share;
    if (!cut.dark_end()) return;
    r.doubts.push_back(
        {fmt::format("Of the air round the head {:.0f} % and of its inside {:.0f} % show exactly the least value: the "
                     "dark end of the greys was cut off, as a window for pictures does, and skin that is as dark with "
                     "it; the surface may lie too deep there",
                     100 * cut.air_share, 100 * cut.body_share),
         "Give the series as the scanner made it, or convert it without a window; look at the skin in the report."});
}

void judge_echo(const Volume& volume, SkinJudgement& r) {
    const auto echo = strongest_echo(volume);
    if (!echo) return;
    r.echo = echo->strength;
    if (!echo->is_movement()) return;
    r.doubts.push_back(
        {fmt::format("The series shows the head twice, {:.0f} mm apart along {}: the patient seems to have moved while "
                     "it was taken, and the surface is the outermost of both outlines",
                     echo->shift_in_ct.norm(), way_in_words(echo->shift_in_ct)),
         "Give a series in which the patient lay still; look at the skin in the report."});
}

}  // namespace

std::string way_in_words(const Eigen::Vector3d& along_in_ct) {
    Eigen::Index axis = 0;
    along_in_ct.cwiseAbs().maxCoeff(&axis);
    constexpr const char* kWays[] = {"left and right", "front and back", "head and feet"};
    return kWays[axis];
}

void doubt_series(const Volume& volume, const SkinMask& mask, const HeadBall& ball, const CtGreys& greys,
                  SkinJudgement& judgement) {
    judge_greys(greys, judgement);
    judge_noise(judgement);
    judge_fat_shift(volume, judgement);
    judge_steps(volume, judgement);
    judge_movement(volume, mask, ball, judgement);
    judge_cut_greys(volume, mask, judgement);
    if (volume.modality == "MR") judge_echo(volume, judgement);
}

}  // namespace planlight
