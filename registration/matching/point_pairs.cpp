#include "registration/matching/point_pairs.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace planlight {
namespace {

RigidTransform fit(const std::vector<PointPair>& pairs) {
    Eigen::Matrix3Xd in_ct(3, pairs.size()), in_rig(3, pairs.size());
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        in_ct.col(static_cast<Eigen::Index>(i)) = pairs[i].in_ct;
        in_rig.col(static_cast<Eigen::Index>(i)) = pairs[i].in_rig;
    }
    return fit_rigid_transform(in_ct, in_rig);
}

double rms(const std::vector<double>& errors) {
    double squares = 0;
    for (const double e : errors) squares += e * e;
    return errors.empty() ? 0 : std::sqrt(squares / static_cast<double>(errors.size()));
}

/// How far the landmarks lie from the line that fits them best, rms.
double spread_mm(const std::vector<PointPair>& pairs) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const PointPair& p : pairs) middle += p.in_ct / static_cast<double>(pairs.size());
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    for (const PointPair& p : pairs)
        squares += (p.in_ct - middle) * (p.in_ct - middle).transpose() / static_cast<double>(pairs.size());
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(squares);
    return std::sqrt(std::max(solver.eigenvalues()[0] + solver.eigenvalues()[1], 0.));
}

PoseCovariance covariance_of(const std::vector<PointPair>& pairs, double error_rms_mm) {
    PoseCovariance covariance;
    for (const PointPair& p : pairs) covariance.centre_in_ct += p.in_ct / static_cast<double>(pairs.size());
    Eigen::Matrix<double, 6, 6> H = Eigen::Matrix<double, 6, 6>::Zero();
    for (const PointPair& p : pairs) {
        const Eigen::Matrix<double, 3, 6> J = movement_by_twist(p.in_ct - covariance.centre_in_ct);
        H += J.transpose() * J;
    }
    covariance.of_turn_and_shift = error_rms_mm * error_rms_mm / 3 * H.inverse();
    return covariance;
}

/// The landmark without which the rest would fit three times better; empty when there is none (or too few to tell).
std::string odd_one_out(const std::vector<PointPair>& pairs, double rms_mm) {
    constexpr double kAlike_mm = 0.5;  // no landmark is touched more exactly
    if (pairs.size() < 5 || rms_mm < kAlike_mm) return {};
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        std::vector<PointPair> rest = pairs;
        rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
        if (3 * rms(landmark_errors_mm(rest, fit(rest))) < rms_mm) return pairs[i].name;
    }
    return {};
}

void lower(RegistrationResult& result, Verdict verdict, const std::string& reason) {
    if (result.verdict == Verdict::yes || verdict == Verdict::no) result.verdict = verdict;
    result.reasons.push_back(reason);
}

}  // namespace

std::vector<double> landmark_errors_mm(const std::vector<PointPair>& pairs, const RigidTransform& patient_from_ct) {
    std::vector<double> errors;
    for (const PointPair& p : pairs) errors.push_back((patient_from_ct * p.in_ct - p.in_rig).norm());
    return errors;
}

RegistrationResult register_point_pairs(const std::vector<PointPair>& pairs, const PointPairSettings& settings) {
    RegistrationResult result;
    result.points = pairs.size();
    if (pairs.size() < 3) {
        result.reasons.push_back(fmt::format("only {} landmarks; at least 3 are needed, better 5", pairs.size()));
        return result;
    }
    if (const double spread = spread_mm(pairs); spread < settings.min_spread_mm) {
        result.reasons.push_back(fmt::format(
            "the landmarks lie close together or nearly on one line ({:.0f} mm across it): take some further apart",
            spread));
        return result;
    }
    result.patient_from_ct = result.initial_patient_from_ct = fit(pairs);
    const std::vector<double> errors = landmark_errors_mm(pairs, result.patient_from_ct);
    result.landmarks_off_mm = *std::max_element(errors.begin(), errors.end());
    result.residual_rms_mm = rms(errors);
    const auto n = static_cast<double>(pairs.size());
    // E[residual^2] = (1 - 2/n) error^2 (Sibson 1979)
    const double error_mm = std::max(settings.least_error_mm, result.residual_rms_mm / std::sqrt(1 - 2 / n));
    result.covariance = covariance_of(pairs, error_mm);
    result.inlier_fraction = 1;
    result.verdict = Verdict::ask;
    result.reasons.push_back(
        fmt::format("registered by {} landmarks alone: look at the light on others", pairs.size()));
    const std::string odd = odd_one_out(pairs, result.residual_rms_mm);
    if (!odd.empty())
        result.reasons.push_back(fmt::format("the landmark \"{}\" does not fit the others: is it the right one?", odd));
    if (result.residual_rms_mm > settings.max_residual_mm)
        lower(result, Verdict::no,
              fmt::format("the landmarks lie {:.1f} mm (rms) from where they should; at most {:.1f} mm: wrong names, "
                          "sides, or another patient",
                          result.residual_rms_mm, settings.max_residual_mm));
    return result;
}

void check_with_point_pairs(const std::vector<PointPair>& pairs, RegistrationResult& result,
                            const PointPairSettings& settings) {
    if (result.verdict == Verdict::no || pairs.empty()) return;
    const std::vector<double> errors = landmark_errors_mm(pairs, result.patient_from_ct);
    result.landmarks_off_mm = *std::max_element(errors.begin(), errors.end());
    for (std::size_t i = 0; i < pairs.size(); ++i)
        if (errors[i] > settings.max_check_mm)
            lower(result, errors[i] > 2 * settings.max_check_mm ? Verdict::no : Verdict::ask,
                  fmt::format("the landmark \"{}\" lies {:.1f} mm from where the match puts it", pairs[i].name,
                              errors[i]));
}

}  // namespace planlight
