#include "registration/tracking/fit_pose.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "registration/tracking/external_reliability.h"
#include "registration/tracking/largest_error.h"

namespace planlight {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr double kHuber = 3;        // sigmas
constexpr double kAgreement = 3.5;  // reduced chi-square up to which the markers agree
constexpr double kCalibrationPx = 0.07;
constexpr double kRivalsApart_mm = 0.4;  // where it counts: farther, they are not one answer
constexpr double kSlip_mm = 1;           // that should show
constexpr double kNearLine = 0.2;        // spread across the line that the markers lie along, of that along it

struct Linearised {
    Matrix6 N = Matrix6::Zero();
    Vector6 g = Vector6::Zero();
    double cost = 0, chi_square = 0, squared_px = 0;
};

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
    Eigen::Matrix3d m;
    m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
    return m;
}

Eigen::Vector3d centroid(const std::vector<PatientMarker>& markers, const std::vector<Sighting>& sightings) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Sighting& s : sightings) sum += markers[static_cast<std::size_t>(s.marker)].centre_in_patient;
    return sum / static_cast<double>(sightings.size());
}

/// Normal equations of the twist (rotation about `pivot_in_rig`, then translation), in rig.
std::optional<Linearised> linearise(const RigCalibration& rig, const std::vector<PatientMarker>& markers,
                                    const std::vector<Sighting>& sightings, const RigidTransform& rig_from_patient,
                                    const Eigen::Vector3d& pivot_in_rig) {
    Linearised result;
    for (const Sighting& s : sightings) {
        const Eigen::Vector3d p = rig_from_patient * markers[static_cast<std::size_t>(s.marker)].centre_in_patient;
        Eigen::Matrix<double, 2, 3> by_point;
        const auto pixel = project(s.left ? rig.left_camera : rig.right_camera, p, by_point);
        if (!pixel) return std::nullopt;
        const Eigen::Vector2d error = s.seen.pixel - *pixel;
        const double sigma = sighting_sigma_px(s.seen);
        const double distance = error.norm() / sigma;
        const double robust = distance > kHuber ? kHuber / distance : 1;
        Eigen::Matrix<double, 2, 6> J;
        J << by_point * -cross_matrix(p - pivot_in_rig), by_point;
        result.N += robust / (sigma * sigma) * J.transpose() * J;
        result.g += robust / (sigma * sigma) * J.transpose() * error;
        result.cost += distance > kHuber ? kHuber * (2 * distance - kHuber) : distance * distance;
        result.chi_square += distance * distance;
        result.squared_px += error.squaredNorm();
    }
    return result;
}

RigidTransform moved(const RigidTransform& rig_from_patient, const Vector6& twist,
                     const Eigen::Vector3d& pivot_in_rig) {
    return Eigen::Translation3d(pivot_in_rig) * transform_from_twist(twist) * Eigen::Translation3d(-pivot_in_rig) *
           rig_from_patient;
}

std::vector<Sighting> without(const std::vector<Sighting>& sightings, int marker) {
    std::vector<Sighting> rest;
    std::copy_if(sightings.begin(), sightings.end(), std::back_inserter(rest),
                 [&](const Sighting& s) { return s.marker != marker; });
    return rest;
}

double reduced_chi_square(const PoseFit& fit, std::size_t sightings) {
    return fit.chi_square / std::max(1.0, 2.0 * static_cast<double>(sightings) - 6);
}

/// How far a left-out marker is seen from where the others say it is, mm at its depth.
double deviation_mm(const RigCalibration& rig, const std::vector<PatientMarker>& markers,
                    const std::vector<Sighting>& sightings, int marker, const RigidTransform& rig_from_patient) {
    double worst = 0;
    for (const Sighting& s : sightings) {
        if (s.marker != marker) continue;
        const CameraModel& camera = s.left ? rig.left_camera : rig.right_camera;
        const Eigen::Vector3d p = rig_from_patient * markers[static_cast<std::size_t>(marker)].centre_in_patient;
        const auto pixel = project(camera, p);
        if (!pixel) continue;
        const double mm_per_px = (camera.device_from_rig * p).z() / camera.focal_x;
        worst = std::max(worst, mm_per_px * (*pixel - s.seen.pixel).norm());
    }
    return worst;
}

struct LeftOut {
    int marker = -1;
    std::optional<PoseFit> fit;  ///< empty: too few sightings without it to check
    double chi = 0;
};

/// The fits with each marker left out, the best first; those that cannot be checked last. From each start, as the pose
/// that the wrong marker has turned may lie in another minimum than the one of the rest.
std::vector<LeftOut> leave_one_out(const RigCalibration& rig, const std::vector<PatientMarker>& markers,
                                   const std::vector<Sighting>& sightings, const std::vector<RigidTransform>& starts) {
    std::set<int> seen;
    for (const Sighting& s : sightings) seen.insert(s.marker);
    std::vector<LeftOut> fits;
    for (const int marker : seen) {
        const auto rest = without(sightings, marker);
        LeftOut one{marker, std::nullopt, std::numeric_limits<double>::infinity()};
        for (const RigidTransform& start : starts) {
            if (rest.size() < 4) break;
            const auto fit = fit_pose(rig, markers, rest, start);
            if (fit && (!one.fit || fit->chi_square < one.fit->chi_square)) one.fit = fit;
        }
        if (one.fit) one.chi = reduced_chi_square(*one.fit, rest.size());
        fits.push_back(one);
    }
    std::sort(fits.begin(), fits.end(), [](const LeftOut& a, const LeftOut& b) { return a.chi < b.chi; });
    return fits;
}

/// How a disagreement is explained: by the marker without which the others agree.
struct Explanation {
    int marker = -1;
    RigidTransform pose = RigidTransform::Identity();  ///< without it
    int rival = -1;                                    ///< another that explains it as well; -1: none
    double apart_mm = 0;                               ///< the pose without the rival, at the places that count
};

/// Empty when leaving out one marker does not mend it. Of several rivals the one whose pose is farthest; one that
/// cannot be checked is infinitely far.
std::optional<Explanation> explain(const std::vector<LeftOut>& fits, double chi_of_all,
                                   const Eigen::Vector3d& middle_in_patient,
                                   const std::vector<Eigen::Vector3d>& places_in_patient) {
    if (!fits[0].fit || fits[0].chi >= 0.5 * chi_of_all) return std::nullopt;
    Explanation result{fits[0].marker, fits[0].fit->rig_from_patient};
    for (std::size_t k = 1; k < fits.size(); ++k) {
        if (fits[k].fit && fits[k].chi >= std::max(kAgreement, 1.5 * fits[0].chi)) continue;
        const double apart_mm = fits[k].fit ? largest_distance(result.pose, fits[k].fit->rig_from_patient,
                                                               middle_in_patient, places_in_patient)
                                            : std::numeric_limits<double>::infinity();
        if (result.rival < 0 || apart_mm > result.apart_mm) result.rival = fits[k].marker, result.apart_mm = apart_mm;
    }
    return result;
}

Eigen::Vector3d middle_of(const std::vector<PatientMarker>& markers) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const PatientMarker& m : markers) sum += m.centre_in_patient;
    return sum / static_cast<double>(markers.size());
}

bool nearly_in_line(const std::vector<PatientMarker>& markers, const std::vector<Sighting>& sightings) {
    const Eigen::Vector3d middle = centroid(markers, sightings);
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const Sighting& s : sightings) {
        const Eigen::Vector3d r = markers[static_cast<std::size_t>(s.marker)].centre_in_patient - middle;
        spread += r * r.transpose();
    }
    const Eigen::Vector3d squares =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread, Eigen::EigenvaluesOnly).eigenvalues();
    return squares[1] < kNearLine * kNearLine * squares[2];
}

/// Why a pose of this error is refused.
std::string too_uncertain(const std::vector<PatientMarker>& markers, const std::vector<Sighting>& sightings,
                          double error_mm, double at_most_mm) {
    if (nearly_in_line(markers, sightings))
        return "the markers seen lie nearly in one line, about which the pose may turn: uncover another beside it, or "
               "paste one there and scan again";
    if (!std::isfinite(error_mm)) return "the markers seen do not determine a pose";
    return fmt::format("the markers seen leave the pose uncertain by {:.2f} mm; at most {:.2f} is allowed", error_mm,
                       at_most_mm);
}

/// Whether the markers set aside stand where `fit` puts them: within three sigmas of their sightings and the pose.
void look_at_set_aside(const RigCalibration& rig, const std::vector<PatientMarker>& markers,
                       const std::vector<Sighting>& aside, const PoseFit& fit, CheckedPose& result) {
    std::map<int, double> sigma_mm;
    for (const Sighting& s : aside) {
        const CameraModel& camera = s.left ? rig.left_camera : rig.right_camera;
        const Eigen::Vector3d p = fit.rig_from_patient * markers[static_cast<std::size_t>(s.marker)].centre_in_patient;
        const double mm_per_px = (camera.device_from_rig * p).z() / camera.focal_x;
        double& sigma = sigma_mm[s.marker];
        sigma = std::max(sigma,
                         std::hypot(mm_per_px * sighting_sigma_px(s.seen), predicted_error(fit.uncertainty, p).rms_mm));
    }
    for (const auto& [marker, sigma] : sigma_mm) {
        const double off_mm = deviation_mm(rig, markers, aside, marker, fit.rig_from_patient);
        if (off_mm > 3 * sigma)
            result.doubts.push_back({marker, off_mm});
        else
            result.in_place_again.push_back(marker);
    }
}

}  // namespace

double sighting_sigma_px(const MarkerObservation& seen) {
    return std::hypot(seen.sigma_px, kCalibrationPx);
}

int distinct_markers(const std::vector<Sighting>& sightings) {
    std::set<int> seen;
    for (const Sighting& s : sightings) seen.insert(s.marker);
    return static_cast<int>(seen.size());
}

std::optional<PoseFit> fit_pose(const RigCalibration& rig, const std::vector<PatientMarker>& markers,
                                const std::vector<Sighting>& sightings, const RigidTransform& start) {
    if (sightings.size() < 3) return std::nullopt;
    const Eigen::Vector3d centre = centroid(markers, sightings);
    RigidTransform pose = start;
    auto now = linearise(rig, markers, sightings, pose, pose * centre);
    if (!now) return std::nullopt;
    double damping = 1e-6;
    for (int iteration = 0; iteration < 25 && damping < 1e6; ++iteration) {
        Matrix6 A = now->N;
        A.diagonal() *= 1 + damping;
        const Eigen::LDLT<Matrix6> solver(A);
        if (solver.info() != Eigen::Success || !solver.isPositive()) return std::nullopt;
        const Vector6 twist = solver.solve(now->g);
        if (!twist.allFinite()) return std::nullopt;
        const RigidTransform next = moved(pose, twist, pose * centre);
        const auto then = linearise(rig, markers, sightings, next, next * centre);
        if (!then || then->cost > now->cost * (1 + 1e-12)) {
            damping = std::max(1e-4, damping * 10);
            continue;
        }
        pose = next;
        now = then;
        damping = std::max(1e-9, damping * 0.1);
        if (twist.head<3>().norm() < 1e-8 && twist.tail<3>().norm() < 1e-6) break;
    }
    PoseFit fit;
    fit.rig_from_patient = pose;
    fit.residual_px = std::sqrt(now->squared_px / static_cast<double>(sightings.size()));
    fit.chi_square = now->chi_square;
    return fit;
}

CheckedPose fit_pose_checked(const RigCalibration& rig, const std::vector<PatientMarker>& markers,
                             std::vector<Sighting> sightings, const RigidTransform& start,
                             const TrackingSettings& settings, const std::vector<Eigen::Vector3d>& places_in_patient,
                             const std::vector<int>& set_aside) {
    CheckedPose result;
    std::vector<Sighting> aside;
    std::ranges::copy_if(sightings, std::back_inserter(aside),
                         [&](const Sighting& s) { return std::ranges::find(set_aside, s.marker) != set_aside.end(); });
    for (const Sighting& s : aside) sightings = without(sightings, s.marker);
    const auto refused = [&result](std::string reason) {
        result.reason = std::move(reason);
        return result;
    };
    const int all = static_cast<int>(markers.size());
    double rivals_apart_mm = 0;
    while (true) {
        const int seen = distinct_markers(sightings);
        if (seen < settings.min_markers)
            return refused(fmt::format("only {} of {} markers seen{}; {} are needed", seen, all,
                                       result.doubts.empty() && aside.empty() ? "" : " in their place",
                                       settings.min_markers));
        if (sightings.size() < 4)
            return refused(fmt::format("{} markers, each seen by one camera only: nothing to check the pose by", seen));
        auto fit = fit_pose(rig, markers, sightings, start);
        if (!fit) return refused("the markers seen do not determine a pose");
        const double chi = reduced_chi_square(*fit, sightings.size());
        if (chi >= kAgreement) {
            std::vector<LeftOut> fits;
            if (seen > settings.min_markers)
                fits = leave_one_out(rig, markers, sightings, {fit->rig_from_patient, start});
            if (fits.empty() || !fits[0].fit)
                return refused(
                    fmt::format("the {} markers seen do not agree, and so few cannot tell which of them has "
                                "moved: uncover another, or scan again",
                                seen));
            if (const auto found = explain(fits, chi, middle_of(markers), places_in_patient)) {
                if (found->rival >= 0 && !(found->apart_mm <= kRivalsApart_mm))
                    return refused(fmt::format("a marker has moved, but it cannot be told whether {} or {}",
                                               found->marker + 1, found->rival + 1));
                rivals_apart_mm += found->apart_mm;
                result.doubts.push_back({found->marker,
                                         deviation_mm(rig, markers, sightings, found->marker, found->pose),
                                         found->rival < 0});
                sightings = without(sightings, found->marker);
                continue;
            }
        }
        if (fit->residual_px > settings.max_residual_px)
            return refused(fmt::format("the markers do not fit their places: {:.2f} px rms, at most {:.2f} is allowed",
                                       fit->residual_px, settings.max_residual_px));
        fit->uncertainty = pose_uncertainty(rig, markers, sightings, fit->rig_from_patient);
        fit->uncertainty.of_turn_and_shift *= std::max(1.0, chi);
        const PredictedError largest = largest_error(fit->uncertainty, fit->rig_from_patient, places_in_patient);
        fit->error_mm = largest.rms_mm + rivals_apart_mm;
        fit->bound_95_mm = largest.bound_95_mm + rivals_apart_mm;
        if (!(fit->error_mm <= settings.max_predicted_error_mm))
            return refused(too_uncertain(markers, sightings, fit->error_mm, settings.max_predicted_error_mm));
        const double noticed = kAgreement * std::max(1.0, 2.0 * static_cast<double>(sightings.size()) - 6);
        fit->external_reliability_mm = external_reliability_mm(rig, markers, sightings, fit->rig_from_patient,
                                                               places_in_patient, kSlip_mm, noticed);
        if (!places_in_patient.empty() && !(fit->external_reliability_mm <= settings.max_external_reliability_mm))
            return refused(
                "so few markers are seen that a slip of one would not show, and the plan could lie far off: uncover "
                "another, or paste one and scan again");
        look_at_set_aside(rig, markers, aside, *fit, result);
        result.fit = fit;
        result.used = sightings;
        return result;
    }
}

}  // namespace planlight
