#include "registration/tracking/largest_error.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "planning_io/types/even_direction.h"

namespace planlight {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Where on the sphere about the middle the error is looked at: see the header. Offsets from the middle.
std::vector<Vector3d> places_on_sphere(const PoseUncertainty& uncertainty) {
    const Matrix3d turn = uncertainty.of_turn_and_shift.topLeftCorner<3, 3>(),
                   turn_and_shift = uncertainty.of_turn_and_shift.topRightCorner<3, 3>();
    const Matrix3d A = turn.trace() * Matrix3d::Identity() - turn;
    Vector3d b = Vector3d::Zero();
    for (int axis = 0; axis < 3; ++axis) b += Vector3d::Unit(axis).cross(turn_and_shift.col(axis));
    const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(A);
    Vector3d r = kPlanReach_mm * eigen.eigenvectors().col(2);
    if (b.dot(r) < 0) r = -r;
    for (int round = 0; round < 30; ++round) {
        const Vector3d up = A * r + b;
        if (up.norm() > 0) r = kPlanReach_mm * up.normalized();
    }
    std::vector<Vector3d> places{r};
    for (int axis = 0; axis < 3; ++axis)
        for (const double sign : {-1., 1.}) places.push_back(sign * kPlanReach_mm * eigen.eigenvectors().col(axis));
    return places;
}

void take_larger(PredictedError& largest, const PredictedError& other) {
    largest.rms_mm = std::max(largest.rms_mm, other.rms_mm);
    largest.bound_95_mm = std::max(largest.bound_95_mm, other.bound_95_mm);
}

}  // namespace

PredictedError predicted_error(const PoseUncertainty& uncertainty, const Eigen::Vector3d& p_in_rig) {
    // The rule is the same in every frame: here everything is in rig.
    return predicted_error(PoseCovariance{uncertainty.of_turn_and_shift, uncertainty.middle_in_rig}, p_in_rig);
}

PredictedError largest_error(const PoseUncertainty& uncertainty, const RigidTransform& rig_from_patient,
                             const std::vector<Vector3d>& places_in_patient) {
    constexpr double kInfinite = std::numeric_limits<double>::infinity();
    if (!uncertainty.of_turn_and_shift.allFinite()) return {kInfinite, kInfinite};
    PredictedError largest;
    for (const Vector3d& p : places_in_patient)
        take_larger(largest, predicted_error(uncertainty, rig_from_patient * p));
    if (!places_in_patient.empty()) return largest;
    for (const Vector3d& r : places_on_sphere(uncertainty))
        take_larger(largest, predicted_error(uncertainty, uncertainty.middle_in_rig + r));
    return largest;
}

double largest_distance(const RigidTransform& a, const RigidTransform& b, const Vector3d& middle_in_patient,
                        const std::vector<Vector3d>& places_in_patient) {
    double largest = 0;
    for (const Vector3d& p : places_in_patient) largest = std::max(largest, (a * p - b * p).norm());
    if (!places_in_patient.empty()) return largest;
    return (a * middle_in_patient - b * middle_in_patient).norm() +
           2 * kPlanReach_mm * std::sin(0.5 * angle_between(a, b));
}

std::vector<Vector3d> outermost(const std::vector<Vector3d>& places) {
    constexpr int kDirections = 200;
    if (places.size() <= kDirections) return places;
    std::set<std::size_t> kept;
    for (int k = 0; k < kDirections; ++k) {
        const Vector3d direction = even_direction(k, kDirections);
        std::size_t farthest = 0;
        for (std::size_t i = 1; i < places.size(); ++i)
            if (direction.dot(places[i]) > direction.dot(places[farthest])) farthest = i;
        kept.insert(farthest);
    }
    std::vector<Vector3d> result;
    for (const std::size_t i : kept) result.push_back(places[i]);
    return result;
}

}  // namespace planlight
