#include "registration/matching/register_patient.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "registration/matching/cloud_pieces.h"
#include "registration/matching/covered_skin.h"
#include "registration/matching/find_skin.h"
#include "registration/matching/free_space.h"
#include "registration/matching/innermost_layer.h"
#include "registration/matching/judge_match.h"
#include "registration/matching/measure_displacement.h"
#include "registration/matching/smooth_deformation.h"

namespace planlight {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::size_t finite_points(const PointCloud& cloud) {
    return static_cast<std::size_t>(std::count_if(cloud.points_in_rig.begin(), cloud.points_in_rig.end(),
                                                  [](const Eigen::Vector3d& p) { return p.allFinite(); }));
}

/// Why the cloud cannot be registered at all; empty when it can be tried.
std::string unfit(const PointCloud& cloud, const RegistrationSettings& settings, int min_points) {
    const std::size_t points = finite_points(cloud);
    if (points < static_cast<std::size_t>(std::max(min_points, 12)))
        return fmt::format("the scan has only {} points on surfaces; at least {} are needed", points, min_points);
    if (cloud.normals_in_rig.size() != cloud.size())
        return "the scan has no normals; it must tell which side of the skin the cameras saw";
    const Eigen::Vector3d extents = extents_mm(cloud);
    if (extents[1] < settings.min_extent_mm)
        return fmt::format("the scan covers only {:.0f} mm x {:.0f} mm; at least {:.0f} mm both ways are needed",
                           std::floor(extents[0]), std::floor(extents[1]), settings.min_extent_mm);
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

/// Skin that sagged takes the pose with it: how far shows by how its places stand apart alone.
void widen_by_spread(const SkinDisplacement& skin, const RegistrationSettings& settings, PoseCovariance& covariance) {
    const double more_mm = std::max(0.0, spread_of_skin_mm(skin) - settings.still_skin_spread_mm);
    covariance.of_turn_and_shift.diagonal().tail<3>().array() += std::pow(settings.shift_by_spread * more_mm, 2);
}

/// A head of another shape: where it was bent along its own skin no pose is right, and the light is off by as much.
void widen_by_shape(double shape_change_mm, PoseCovariance& covariance) {
    constexpr double kSigmas = 2.8;  // of a 95 % bound in space
    covariance.of_turn_and_shift.diagonal().tail<3>().array() += std::pow(shape_change_mm / kSigmas, 2);
}

/// A pose, and what of the scan it was fitted to.
struct FinePose {
    std::optional<PointCloud> layer;  ///< empty: all of it
    IcpResult icp;
    DeformablePose settled;
};

void refine_pose(const PointCloud& skin, const SkinLut& lut, const RigidTransform& start_ct_from_rig,
                 const IcpSettings& icp, const DeformableSettings& deformable, FinePose& fine) {
    fine.icp = refine_icp(skin, lut, start_ct_from_rig, icp);
    fine.settled = refine_pose_deformable(skin, lut, fine.icp.ct_from_rig, deformable);
}

/// What was left out as cloth may have been skin that moved, or some of the cloth be left: a share of the way that the
/// pose went for it, one standard deviation, along that way.
void widen_by_way(const RigidTransform& of_all_ct_from_rig, double share, DeformablePose& settled) {
    if (!settled.known()) return;
    const RigidTransform way = settled.ct_from_rig * of_all_ct_from_rig.inverse();
    const Eigen::AngleAxisd turn(way.linear());
    const Eigen::Vector3d& centre = settled.covariance.centre_in_ct;
    Eigen::Matrix<double, 6, 1> went;
    went << turn.angle() * turn.axis(), way * centre - centre;
    settled.covariance.of_turn_and_shift += share * share * went * went.transpose();
}

/// Cloth that lies close on the skin pulls the pose outwards and stands for skin that moved: it is left out by turns
/// with the pose, which is then that of the skin alone.
void leave_cloth_out(const PointCloud& cloud, const SkinLut& lut, const RegistrationSettings& settings,
                     FinePose& fine) {
    constexpr int kRounds = 5;
    constexpr std::size_t kSame = 100;  // a hundredth of the points
    IcpSettings close = settings.icp;
    close.first_scale_mm = 1;
    const RigidTransform of_all = fine.settled.ct_from_rig;
    for (int round = 0; round < kRounds; ++round) {
        std::optional<PointCloud> layer = innermost_layer(cloud, lut, fine.settled.ct_from_rig);
        const std::size_t before = fine.layer ? fine.layer->size() : cloud.size(),
                          after = layer ? layer->size() : cloud.size();
        if (kSame * (std::max(before, after) - std::min(before, after)) <= cloud.size()) break;
        fine.layer = std::move(layer);
        refine_pose(fine.layer ? *fine.layer : cloud, lut, fine.settled.ct_from_rig, close, settings.skin, fine);
    }
    widen_by_way(of_all, settings.left_out_share, fine.settled);
}

/// The fine match from `start`, and what it is judged by; returns the skin's fit for the judgement. `seen`: all that
/// the devices saw, cloth as well: the way back from there must be free. `under_cloth`: `cloud` was chosen from it, and
/// may hold cloth that lies close on the skin; the fit is that of all of `cloud`.
FineMatch match_finely(const PointCloud& cloud, const PointCloud& seen, const SkinLut& lut,
                       const RigidTransform& start_ct_from_rig, const RegistrationSettings& settings, bool under_cloth,
                       RegistrationResult& result) {
    const auto start = std::chrono::steady_clock::now();
    result.initial_patient_from_ct = start_ct_from_rig.inverse();
    FinePose fine_pose;
    refine_pose(cloud, lut, start_ct_from_rig, settings.icp, settings.skin, fine_pose);
    if (under_cloth && settings.leave_cloth_out) leave_cloth_out(cloud, lut, settings, fine_pose);
    const PointCloud& skin = fine_pose.layer ? *fine_pose.layer : cloud;
    IcpResult& icp = fine_pose.icp;
    const DeformablePose& settled = fine_pose.settled;
    if (settings.moved_skin) icp.ct_from_rig = settled.ct_from_rig;
    result.covariance = settled.covariance;
    if (settled.known()) {
        result.skin_movement_mm = settled.movement_mm;
        result.skin_offset_mm = settled.offset_mm;
    }
    result.patient_from_ct = icp.ct_from_rig.inverse();
    result.skin = measure_displacement(skin, lut, icp.ct_from_rig);
    if (const auto deformation = fit_smooth_deformation(skin, lut, icp.ct_from_rig))
        result.shape_change_mm = deformation->probability() * deformation->p95_mm;
    widen_by_spread(result.skin, settings, result.covariance);
    widen_by_shape(result.shape_change_mm.value_or(0), result.covariance);
    result.refine_s = seconds_since(start);

    FineMatch fine{lay_on_skin(cloud, lut, icp.ct_from_rig, settings.inlier_distance_mm,
                               settings.moved_skin ? settled.offset_mm : 0),
                   settled.offset_mm, weakest_way(settled.covariance)};
    result.inlier_fraction = fine.fit.inlier_fraction();
    result.residual_rms_mm = fine.fit.inlier_rms_mm;
    result.residual_median_mm = fine.fit.median_mm;
    if (std::isfinite(fine.weakest.sigma_mm)) result.weakest_sigma_mm = fine.weakest.sigma_mm;
    result.judged_points = fine.fit.known;
    result.scale = settled.scale;
    result.scale_sigma = settled.scale_sigma;
    if (settings.viewpoint_in_rig)
        result.blocked_fraction =
            look_along_rays(seen, lut, icp.ct_from_rig, *settings.viewpoint_in_rig).blocked_fraction();
    return fine;
}

/// A scan, or what of it is skin, matched alone.
struct Attempt {
    RegistrationResult result;
    InitialMatch match;
    FineMatch fine;
};

template <class Keep>
PointCloud part_of(const PointCloud& cloud, const Keep& keep) {
    PointCloud part;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        if (!keep(i)) continue;
        part.points_in_rig.push_back(cloud.points_in_rig[i]);
        if (cloud.normals_in_rig.size() == cloud.size()) part.normals_in_rig.push_back(cloud.normals_in_rig[i]);
    }
    return part;
}

/// No stray; without normals there are no pieces, and every finite point counts.
bool on_a_surface(const CloudPieces& pieces, std::size_t point) {
    const int cell = pieces.cell_of_point[point];
    return pieces.cells.empty() || (cell >= 0 && !pieces.cells[static_cast<std::size_t>(cell)].stray);
}

/// Search, fine match, mirror image and verdict; `result` brings what is known of the whole scan.
Attempt match_alone(const PointCloud& cloud, const PointCloud& seen, const SkinLut& lut, const MatchingSkin& skin,
                    const RegistrationSettings& settings, const RegistrationResult& of_scan, bool under_cloth = false) {
    Attempt attempt{of_scan, find_initial_match(cloud, skin, settings.initial), {}};
    RegistrationResult& result = attempt.result;
    if (attempt.match.candidates.empty()) {
        result.reasons.push_back(
            "no three points of the scan fit the skin together: this is not the surface that the CT shows");
        return attempt;
    }
    result.runner_up_ratio = attempt.match.runner_up_ratio;
    result.agreeing_bases = attempt.match.candidates[0].agreeing_bases;
    attempt.fine =
        match_finely(cloud, seen, lut, attempt.match.candidates[0].ct_from_rig, settings, under_cloth, result);
    if (settings.mirror_test) result.mirror_ratio = mirror_ratio(cloud, skin, attempt.match, settings);
    Judgement judgement(result);
    judge_fit(settings, attempt.fine.fit, result.runner_up_ratio >= 1.3 && result.agreeing_bases >= 2, judgement);
    judge_uniqueness(settings, result, judgement);
    judgement.no_if(result.runner_up_ratio < settings.min_runner_up_ratio &&
                        attempt.fine.fit.inlier_fraction() < settings.min_inlier_fraction && result.mirror_ratio > 0 &&
                        result.mirror_ratio < settings.min_mirror_ratio,
                    "poorly on the skin, and other poses fit nearly as well: three weak signs together");
    judge_fine_match(settings, attempt.fine, result, judgement);
    return attempt;
}

bool same_place(const RigidTransform& a, const RigidTransform& b, const PointCloud& cloud) {
    constexpr double kTurn = 0.06, kShift_mm = 5;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& p : cloud.points_in_rig) middle += p / static_cast<double>(cloud.size());
    return angle_between(a, b) < kTurn && (a * middle - b * middle).norm() < kShift_mm;
}

/// Finds what of the scan is skin, and matches and judges that alone, from any pose again.
Attempt match_among_cloth(const PointCloud& cloud, const CloudPieces& pieces, const SkinLut& lut,
                          const MatchingSkin& skin, const InitialMatch& of_whole, const RegistrationSettings& settings,
                          const RegistrationResult& of_scan) {
    Attempt attempt{of_scan, {}, {}};
    const auto found = find_skin(cloud, pieces, lut, skin, of_whole, settings.initial, settings.find_skin);
    if (!found) return attempt;
    const PointCloud bare = part_of(cloud, [&](std::size_t i) { return found->is_skin[i] != 0; });
    if (!unfit(bare, settings, settings.min_points / 2).empty()) return attempt;
    attempt = match_alone(bare, cloud, lut, skin, settings, of_scan, true);
    attempt.result.skin_fraction = found->skin_fraction;
    if (attempt.match.candidates.empty()) return attempt;
    Judgement judgement(attempt.result, attempt.result.verdict);
    judgement.no_if(!same_place(attempt.result.patient_from_ct.inverse(), found->ct_from_rig, bare),
                    "what looks like skin between cloth fits elsewhere when it is matched alone");
    judge_found_skin(settings, *found, attempt.fine, attempt.result, judgement);
    judgement.no_if(attempt.result.reasons.size() >= 3,
                    "the skin was chosen from the scan because it fits: three weak signs are too many");
    return attempt;
}

/// The surer one; of two that are as sure, the one that does not take cloth for skin.
bool better(const Attempt& among, const Attempt& whole) {
    if (among.match.candidates.empty()) return false;
    return among.result.verdict == whole.result.verdict ? among.result.verdict != Verdict::no
                                                        : among.result.verdict < whole.result.verdict;
}

}  // namespace

RegistrationResult register_patient(const PointCloud& cloud, const SkinLut& lut, const RegistrationSettings& settings) {
    const CloudPieces pieces = cloud_pieces(cloud);
    const PointCloud surfaces = part_of(cloud, [&](std::size_t i) { return on_a_surface(pieces, i); });
    RegistrationResult result;
    result.points = finite_points(cloud);
    result.inlier_distance_mm = settings.inlier_distance_mm;
    if (const std::string problem = unfit(surfaces, settings, settings.min_points); !problem.empty()) {
        result.reasons.push_back(problem);
        return result;
    }
    const auto start = std::chrono::steady_clock::now();
    const MatchingSkin skin(lut, settings.initial);
    Attempt whole = match_alone(surfaces, surfaces, lut, skin, settings, result);
    whole.result.initial_match_s = seconds_since(start) - whole.result.refine_s;
    const bool bare = whole.fine.fit.inlier_fraction() >= settings.among_cloth.bare_fraction;
    const auto with_covered_skin = [&](RegistrationResult& chosen) {
        if (chosen.verdict != Verdict::no)
            add_covered_skin(surfaces, lut, chosen.patient_from_ct.inverse(), chosen.skin);
        return chosen;
    };
    if (whole.result.verdict == Verdict::yes || bare || !settings.look_among_cloth)
        return with_covered_skin(whole.result);
    Attempt among = match_among_cloth(cloud, pieces, lut, skin, whole.match, settings, result);
    among.result.initial_match_s = seconds_since(start) - among.result.refine_s;
    return with_covered_skin(better(among, whole) ? among.result : whole.result);
}

RegistrationResult register_patient_near(const PointCloud& cloud, const SkinLut& lut,
                                         const RigidTransform& start_patient_from_ct,
                                         const RegistrationSettings& settings) {
    RegistrationResult result;
    result.reasons.push_back("the scan was not found by itself, but from a start that was given");
    result.points = finite_points(cloud);
    result.inlier_distance_mm = settings.inlier_distance_mm;
    if (const std::string problem = unfit(cloud, settings, settings.min_points); !problem.empty()) {
        result.reasons.push_back(problem);
        return result;
    }
    const FineMatch fine = match_finely(cloud, cloud, lut, start_patient_from_ct.inverse(), settings, false, result);
    Judgement judgement(result, Verdict::ask);
    judge_fit(settings, fine.fit, true, judgement);
    judge_fine_match(settings, fine, result, judgement);
    return result;
}

}  // namespace planlight
