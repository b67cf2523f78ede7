#include "registration/matching/judge_match.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace planlight {

namespace {

/// Half of the scan on the skin, or a third when the rest is explained: it lies outside of the body, as cloth does, and
/// the place is known otherwise (no other pose comes near, or a start was given).
bool enough_on_skin(const CloudOnSkin& fit, bool place_known) {
    const double on = fit.inlier_fraction(), inside = fit.inside_fraction();
    return on >= 0.5 || (on >= 0.3 && inside < 0.2 * on && place_known);
}

}  // namespace

void judge_fit(const RegistrationSettings& settings, const CloudOnSkin& fit, bool place_known, Judgement& judgement) {
    const double share = fit.inlier_fraction();
    const std::string on_skin = fmt::format("only {:.0f} % of the scan lies on the skin (within {:.1f} mm)",
                                            100 * share, settings.inlier_distance_mm);
    const bool enough = enough_on_skin(fit, place_known);
    judgement.no_if(!enough, on_skin);
    judgement.ask_if(enough && share < settings.min_inlier_fraction, on_skin);
    judgement.ask_if(
        enough && fit.inlier_rms_mm > settings.loose_residual_rms_mm &&
            fit.shape_rms_mm > settings.loose_shape_rms_mm && share < settings.loose_inlier_fraction,
        fmt::format(
            "the scan lies only loosely on the skin: {:.0f} % of it, {:.2f} mm (rms) off, {:.2f} mm without its "
            "own noise",
            100 * share, fit.inlier_rms_mm, fit.shape_rms_mm));
    judgement.no_if(fit.inlier_rms_mm > settings.max_residual_rms_mm,
                    fmt::format("the scan lies {:.2f} mm (rms) from the skin; at most {:.2f} mm is good enough",
                                fit.inlier_rms_mm, settings.max_residual_rms_mm));
    judgement.no_if(fit.known_fraction() < 0.5,
                    fmt::format("only {:.0f} % of the scan lies where the CT shows skin; the rest is beyond its ends",
                                100 * fit.known_fraction()));
}

void judge_uniqueness(const RegistrationSettings& settings, const RegistrationResult& result, Judgement& judgement) {
    const double ratio = result.runner_up_ratio;
    const std::string rival = fmt::format("another pose fits nearly as well (ratio {:.2f})", ratio);
    judgement.no_if(ratio > 0 && ratio < 1.05, rival);
    judgement.ask_if(ratio >= 1.05 && ratio < settings.min_runner_up_ratio, rival);
    judgement.ask_if(result.agreeing_bases < settings.min_agreeing_bases,
                     fmt::format("only {} contact triplet led to this pose; {} must agree", result.agreeing_bases,
                                 settings.min_agreeing_bases));
}

namespace {

void judge_free_space(const RegistrationSettings& settings, const RegistrationResult& result, Judgement& judgement) {
    if (!result.blocked_fraction) return;
    const double blocked = *result.blocked_fraction;
    const std::string through = fmt::format(
        "{:.0f} % of the scan was seen through what is body in the CT, if the viewpoint is right", 100 * blocked);
    judgement.no_if(blocked > settings.far_too_many_blocked, through);
    judgement.ask_if(blocked > settings.max_blocked && blocked <= settings.far_too_many_blocked, through);
}

void judge_mirror_and_scale(const RegistrationSettings& settings, const RegistrationResult& result,
                            Judgement& judgement) {
    const double mirror = result.mirror_ratio;
    judgement.no_if(
        mirror > 0 && mirror < settings.mirror_fits_better,
        fmt::format("the mirror image of the scan fits better (ratio {:.2f}): left and right are exchanged", mirror));
    judgement.ask_if(mirror >= settings.mirror_fits_better && mirror < settings.min_mirror_ratio,
                     fmt::format("the mirror image of the scan fits nearly as well (ratio {:.2f})", mirror));
    const double scale_off = std::abs(result.scale - 1);
    const std::string another =
        fmt::format("the head of the scan is {:.1f} % {} than that of the CT: another patient, or a wrong calibration",
                    100 * std::abs(1 / result.scale - 1), result.scale < 1 ? "larger" : "smaller");
    const bool far = scale_off > std::max(settings.far_too_much_scale, 2 * result.scale_sigma);
    judgement.no_if(far, another);
    judgement.ask_if(!far && (scale_off > std::max(settings.max_scale_error, 1.5 * result.scale_sigma) ||
                              scale_off > std::max(settings.clear_scale_error, 4 * result.scale_sigma)),
                     another);
}

/// One sentence at most: too few points on skin are one reason, whatever cannot be told for them.
void judge_what_is_known(const FineMatch& fine, const RegistrationResult& result, Judgement& judgement) {
    if (!std::isfinite(fine.weakest.sigma_mm))
        judgement.ask_if(true,
                         "too few points of the scan lie on skin to tell how far the patient could lie elsewhere: scan "
                         "more of the head, or nearer");
    else if (!result.skin.known())
        judgement.ask_if(true,
                         "too few points of the scan lie on skin to tell where the skin lies now: light that meets it "
                         "at a slant may fall aside");
    else if (!result.shape_change_mm)
        judgement.ask_if(true,
                         "too few points of the scan lie on skin to tell whether the head has the shape of the CT's: "
                         "look at the light on landmarks");
}

}  // namespace

void judge_fine_match(const RegistrationSettings& settings, const FineMatch& fine, const RegistrationResult& result,
                      Judgement& judgement) {
    judge_free_space(settings, result, judgement);
    judge_mirror_and_scale(settings, result, judgement);
    judge_what_is_known(fine, result, judgement);
    judgement.ask_if(
        std::abs(fine.skin_offset_mm) > settings.max_skin_offset_mm,
        fmt::format("the whole skin lies {:.1f} mm {} that of the CT: swollen, or not the threshold of the skin",
                    std::abs(fine.skin_offset_mm), fine.skin_offset_mm > 0 ? "outside" : "inside"));
    const double movement_mm = result.skin_movement_mm.value_or(0), shape_mm = result.shape_change_mm.value_or(0);
    judgement.ask_if(
        movement_mm > settings.max_skin_movement_mm,
        fmt::format("the skin has moved by {:.1f} mm (rms) since the CT, and a part of that can look like a head that "
                    "lies otherwise: look at the light where skin lies close on bone",
                    movement_mm));
    const double spread_mm = spread_of_skin_mm(result.skin);
    judgement.ask_if(
        movement_mm <= settings.max_skin_movement_mm && spread_mm > settings.max_skin_spread_mm,
        fmt::format(
            "places of the skin lie {:.2f} mm (one sigma) off those of the CT: skin that sagged or swelled since "
            "can look like a head that lies otherwise: look at the light where skin lies close on bone",
            spread_mm));
    judgement.ask_if(
        shape_mm > settings.max_shape_change_mm,
        fmt::format("the head of the scan fits the CT better when it is stretched, sheared or twisted, and light could "
                    "lie {:.1f} mm off: another patient, one who moved during the CT, a distorted MR or a wrong "
                    "calibration: look at the light on landmarks",
                    shape_mm));
    const bool weak = fine.weakest.sigma_mm > settings.max_weakest_sigma_mm;
    judgement.ask_if(weak && std::isfinite(fine.weakest.sigma_mm),
                     fmt::format("the patient could {} by {:.1f} mm unnoticed: scan {} as well", fine.weakest.in_words,
                                 fine.weakest.sigma_mm, fine.weakest.advice));
    judgement.ask_if(
        !weak && fine.weakest.sigma_mm > settings.weak_sigma_mm && fine.fit.shape_rms_mm > settings.max_shape_rms_mm,
        fmt::format("what was scanned has not quite the shape of the skin ({:.1f} mm rms beside the scan's own "
                    "noise), and could be cloth on it or skin that moved; the patient could {} by {:.1f} mm "
                    "unnoticed: scan {} as well",
                    fine.fit.shape_rms_mm, fine.weakest.in_words, fine.weakest.sigma_mm, fine.weakest.advice));
}

void judge_found_skin(const RegistrationSettings& settings, const FoundSkin& found, const FineMatch& fine,
                      const RegistrationResult& result, Judgement& judgement) {
    const AmongClothLimits& limits = settings.among_cloth;
    const double inside = found.inside_fraction;
    const std::string within =
        fmt::format("{:.0f} % of the scan lies deeper in the body of the CT than light reaches", 100 * inside);
    judgement.no_if(inside > limits.far_too_much_inside, within);
    judgement.ask_if(inside > limits.max_inside && inside <= limits.far_too_much_inside, within);
    judgement.no_if(found.skin_fraction < limits.far_too_little_skin,
                    fmt::format("only {:.0f} % of the scan is skin", 100 * found.skin_fraction));
    judgement.ask_if(
        found.goes_on_fraction > limits.max_goes_on && result.residual_rms_mm > limits.max_rms_goes_on_mm,
        fmt::format("the surface goes on smoothly, off the skin, over {:.0f} % of what lies on it: another "
                    "patient, or cloth close to the skin",
                    100 * found.goes_on_fraction));
    const std::string rival =
        fmt::format("another pose explains nearly as much of the scan (ratio {:.2f})", found.rival_ratio);
    judgement.no_if(found.rival_ratio > 0 && found.rival_ratio < 1.05, rival);
    judgement.ask_if(found.rival_ratio >= 1.05 && found.rival_ratio < limits.min_rival_ratio, rival);
    judgement.ask_if(
        result.runner_up_ratio >= settings.min_runner_up_ratio && result.runner_up_ratio < limits.min_runner_up_ratio,
        fmt::format("the skin between cloth fits elsewhere too (ratio {:.2f})", result.runner_up_ratio));
    judgement.ask_if(
        result.mirror_ratio >= settings.min_mirror_ratio && result.mirror_ratio < limits.min_mirror_ratio,
        fmt::format("the mirror image of the skin between cloth fits too (ratio {:.2f})", result.mirror_ratio));
    judgement.ask_if(
        result.residual_rms_mm > limits.max_residual_rms_mm,
        fmt::format("what looks like skin between cloth lies {:.2f} mm (rms) from it", result.residual_rms_mm));
    const double on = fine.fit.inlier_fraction();
    const std::string off = fmt::format("only {:.0f} % of what looks like skin lies on it", 100 * on);
    judgement.no_if(on < limits.far_too_few_inliers, off);
    judgement.ask_if(on >= limits.far_too_few_inliers && on < limits.min_inlier_fraction, off);
    judgement.no_if(std::abs(result.scale - 1) > std::max(limits.far_too_much_scale, 2 * result.scale_sigma),
                    fmt::format("what looks like skin between cloth is that of a head {:.0f} % {}: another patient",
                                100 * std::abs(1 / result.scale - 1), result.scale < 1 ? "larger" : "smaller"));
}

}  // namespace planlight
