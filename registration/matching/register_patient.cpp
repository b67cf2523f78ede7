#include "registration/matching/register_patient.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "registration/matching/free_space.h"
#include "registration/matching/match_evidence.h"
#include "registration/matching/measure_displacement.h"

namespace planlight {
namespace {

/// The verdict as it grows worse, with a sentence for each step.
class Judgement {
public:
    explicit Judgement(RegistrationResult& result, Verdict at_best = Verdict::yes) : result_(result) {
        result_.verdict = at_best;
    }
    void ask_if(bool doubtful, const std::string& reason) { lower_if(doubtful, Verdict::ask, reason); }
    void no_if(bool wrong, const std::string& reason) { lower_if(wrong, Verdict::no, reason); }

private:
    void lower_if(bool condition, Verdict verdict, const std::string& reason) {
        if (!condition) return;
        if (result_.verdict != Verdict::no) result_.verdict = verdict;
        result_.reasons.push_back(reason);
    }
    RegistrationResult& result_;
};

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::size_t finite_points(const PointCloud& cloud) {
    return static_cast<std::size_t>(std::count_if(cloud.points_in_rig.begin(), cloud.points_in_rig.end(),
                                                  [](const Eigen::Vector3d& p) { return p.allFinite(); }));
}

/// Why the cloud cannot be registered at all; empty when it can be tried.
std::string unfit(const PointCloud& cloud, const RegistrationSettings& settings, std::size_t points) {
    if (points < static_cast<std::size_t>(std::max(settings.min_points, 12)))
        return fmt::format("the scan has only {} points; at least {} are needed", points, settings.min_points);
    if (cloud.normals_in_rig.size() != cloud.size())
        return "the scan has no normals; it must tell which side of the skin the cameras saw";
    const Eigen::Vector3d extents = extents_mm(cloud);
    if (extents[1] < settings.min_extent_mm)
        return fmt::format("the scan covers only {:.0f} mm x {:.0f} mm; at least {:.0f} mm both ways are needed",
                           extents[0], extents[1], settings.min_extent_mm);
    return {};
}

/// Cost of the best pose of the mirrored scan / cost of this pose, over the same points; below 1 the mirror image fits
/// better.
double mirror_ratio(const PointCloud& cloud, const MatchingSkin& skin, const InitialMatch& match,
                    const RegistrationSettings& settings) {
    constexpr double kNoise_mm = 0.05;
    InitialMatchSettings search = settings.initial;
    search.max_bases = search.min_bases;
    const InitialMatch image = find_initial_match(mirrored(cloud), skin, search);
    if (image.candidates.empty()) return 0;
    return (image.candidates[0].cost_mm + kNoise_mm) / (match.candidates[0].cost_mm + kNoise_mm);
}

/// Half of the scan on the skin, or a third when the rest is explained: it lies outside of the body, as cloth does, and
/// the place is known otherwise (no other pose comes near, or a start was given).
bool enough_on_skin(const CloudOnSkin& fit, bool place_known) {
    const double on = fit.inlier_fraction(), inside = fit.inside_fraction();
    return on >= 0.5 || (on >= 0.3 && inside < 0.2 * on && place_known);
}

void judge_fit(const RegistrationSettings& settings, const CloudOnSkin& fit, bool place_known, Judgement& judgement) {
    const double share = fit.inlier_fraction();
    const std::string on_skin = fmt::format("only {:.0f} % of the scan lies on the skin (within {:.1f} mm)",
                                            100 * share, settings.inlier_distance_mm);
    const bool enough = enough_on_skin(fit, place_known);
    judgement.no_if(!enough, on_skin);
    judgement.ask_if(enough && share < settings.min_inlier_fraction, on_skin);
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
    judgement.ask_if(
        std::abs(result.scale - 1) > std::max(settings.max_scale_error, 1.5 * result.scale_sigma),
        fmt::format("the head of the scan is {:.1f} % {} than that of the CT: another patient, or a wrong calibration",
                    100 * std::abs(1 / result.scale - 1), result.scale < 1 ? "larger" : "smaller"));
}

/// The fine match from `start`, and what it is judged by; returns the skin's fit for the judgement.
struct FineMatch {
    CloudOnSkin fit;
    double skin_offset_mm = 0;
    WeakestWay weakest;
};
FineMatch match_finely(const PointCloud& cloud, const SkinLut& lut, const RigidTransform& start_ct_from_rig,
                       const RegistrationSettings& settings, RegistrationResult& result) {
    const auto start = std::chrono::steady_clock::now();
    result.initial_patient_from_ct = start_ct_from_rig.inverse();
    IcpResult icp = refine_icp(cloud, lut, start_ct_from_rig, settings.icp);
    const DeformablePose settled = refine_pose_deformable(cloud, lut, icp.ct_from_rig, settings.skin);
    if (settings.moved_skin) icp.ct_from_rig = settled.ct_from_rig;
    result.covariance = settled.covariance;
    result.skin_movement_mm = settled.movement_mm;
    result.skin_offset_mm = settled.offset_mm;
    result.refine_s = seconds_since(start);
    result.patient_from_ct = icp.ct_from_rig.inverse();
    result.skin = measure_displacement(cloud, lut, icp.ct_from_rig);

    FineMatch fine{lay_on_skin(cloud, lut, icp.ct_from_rig, settings.inlier_distance_mm,
                               settings.moved_skin ? settled.offset_mm : 0),
                   settled.offset_mm, weakest_way(settled.covariance)};
    result.inlier_fraction = fine.fit.inlier_fraction();
    result.residual_rms_mm = fine.fit.inlier_rms_mm;
    result.residual_median_mm = fine.fit.median_mm;
    result.weakest_sigma_mm = fine.weakest.sigma_mm;
    result.scale = settled.scale;
    result.scale_sigma = settled.scale_sigma;
    if (settings.viewpoint_in_rig)
        result.blocked_fraction =
            look_along_rays(cloud, lut, icp.ct_from_rig, *settings.viewpoint_in_rig).blocked_fraction();
    return fine;
}

void judge_fine_match(const RegistrationSettings& settings, const FineMatch& fine, const RegistrationResult& result,
                      Judgement& judgement) {
    judge_free_space(settings, result, judgement);
    judge_mirror_and_scale(settings, result, judgement);
    judgement.ask_if(
        std::abs(fine.skin_offset_mm) > settings.max_skin_offset_mm,
        fmt::format("the whole skin lies {:.1f} mm {} that of the CT: swollen, or not the threshold of the skin",
                    std::abs(fine.skin_offset_mm), fine.skin_offset_mm > 0 ? "outside" : "inside"));
    judgement.ask_if(fine.weakest.sigma_mm > settings.max_weakest_sigma_mm,
                     fmt::format("the patient could {} by {:.1f} mm unnoticed: scan {} as well", fine.weakest.in_words,
                                 fine.weakest.sigma_mm, fine.weakest.advice));
}

}  // namespace

RegistrationResult register_patient(const PointCloud& cloud, const SkinLut& lut, const RegistrationSettings& settings) {
    RegistrationResult result;
    result.points = finite_points(cloud);
    result.inlier_distance_mm = settings.inlier_distance_mm;
    if (const std::string problem = unfit(cloud, settings, result.points); !problem.empty()) {
        result.reasons.push_back(problem);
        return result;
    }
    const auto start = std::chrono::steady_clock::now();
    const MatchingSkin skin(lut, settings.initial);
    const InitialMatch match = find_initial_match(cloud, skin, settings.initial);
    result.initial_match_s = seconds_since(start);
    if (match.candidates.empty()) {
        result.reasons.push_back(
            "no three points of the scan fit the skin together: this is not the surface that the CT shows");
        return result;
    }
    result.runner_up_ratio = match.runner_up_ratio;
    result.agreeing_bases = match.candidates[0].agreeing_bases;
    const FineMatch fine = match_finely(cloud, lut, match.candidates[0].ct_from_rig, settings, result);
    if (settings.mirror_test) result.mirror_ratio = mirror_ratio(cloud, skin, match, settings);

    Judgement judgement(result);
    judge_fit(settings, fine.fit, result.runner_up_ratio >= 1.3 && result.agreeing_bases >= 2, judgement);
    judge_uniqueness(settings, result, judgement);
    judgement.no_if(result.runner_up_ratio < settings.min_runner_up_ratio &&
                        fine.fit.inlier_fraction() < settings.min_inlier_fraction && result.mirror_ratio > 0 &&
                        result.mirror_ratio < settings.min_mirror_ratio,
                    "poorly on the skin, and other poses fit nearly as well: three weak signs together");
    judge_fine_match(settings, fine, result, judgement);
    return result;
}

RegistrationResult register_patient_near(const PointCloud& cloud, const SkinLut& lut,
                                         const RigidTransform& start_patient_from_ct,
                                         const RegistrationSettings& settings) {
    RegistrationResult result;
    result.reasons.push_back("the scan was not found by itself, but from a start that was given");
    result.points = finite_points(cloud);
    result.inlier_distance_mm = settings.inlier_distance_mm;
    if (const std::string problem = unfit(cloud, settings, result.points); !problem.empty()) {
        result.reasons.push_back(problem);
        return result;
    }
    const FineMatch fine = match_finely(cloud, lut, start_patient_from_ct.inverse(), settings, result);
    Judgement judgement(result, Verdict::ask);
    judge_fit(settings, fine.fit, true, judgement);
    judge_fine_match(settings, fine, result, judgement);
    return result;
}

}  // namespace planlight
