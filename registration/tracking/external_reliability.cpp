#include "registration/tracking/external_reliability.h"

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "planning_io/types/even_direction.h"
#include "registration/tracking/fit_pose.h"
#include "registration/tracking/largest_error.h"

namespace planlight {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Matrix63 = Eigen::Matrix<double, 6, 3>;

/// What the sightings of one marker weigh: of its own place, and of that against the twist.
struct Weight {
    Matrix3d of_place = Matrix3d::Zero();
    Matrix63 of_twist_and_place = Matrix63::Zero();
};

}  // namespace

double external_reliability_mm(const RigCalibration& rig, const std::vector<PatientMarker>& markers,
                               const std::vector<Sighting>& sightings, const RigidTransform& pose,
                               const std::vector<Vector3d>& places_in_patient, double slip_mm,
                               double noticed_chi_square) {
    constexpr double kInfinite = std::numeric_limits<double>::infinity();
    constexpr int kDirections = 100;  // where no places are told
    Vector3d middle = Vector3d::Zero();
    for (const PatientMarker& m : markers) middle += pose * m.centre_in_patient / static_cast<double>(markers.size());
    Matrix6 N = Matrix6::Zero();
    std::map<int, Weight> weights;
    for (const Sighting& s : sightings) {
        const Vector3d p = pose * markers[static_cast<std::size_t>(s.marker)].centre_in_patient;
        Eigen::Matrix<double, 2, 3> by_point;
        if (!project(s.left ? rig.left_camera : rig.right_camera, p, by_point)) return kInfinite;
        by_point /= sighting_sigma_px(s.seen);
        const Eigen::Matrix<double, 2, 6> J = by_point * movement_by_twist(p - middle);
        N += J.transpose() * J;
        weights[s.marker].of_place += by_point.transpose() * by_point;
        weights[s.marker].of_twist_and_place += J.transpose() * by_point;
    }
    const Eigen::LDLT<Matrix6> solver(N);
    if (solver.info() != Eigen::Success || !(solver.vectorD().minCoeff() > 0)) return kInfinite;
    std::vector<Vector3d> from_middle;
    for (const Vector3d& p : places_in_patient) from_middle.push_back(pose * p - middle);
    for (int k = 0; places_in_patient.empty() && k < kDirections; ++k)
        from_middle.push_back(kPlanReach_mm * even_direction(k, kDirections));
    double squared = 0;
    for (const auto& [marker, weight] : weights) {
        const Matrix63 twist_by_slip = solver.solve(weight.of_twist_and_place);
        const Matrix3d shown = weight.of_place - weight.of_twist_and_place.transpose() * twist_by_slip;
        const Matrix3d limits = shown / noticed_chi_square + Matrix3d::Identity() / (slip_mm * slip_mm);
        const Matrix3d slips = 2 * limits.inverse();
        for (const Vector3d& r : from_middle) {
            const Matrix3d moved = movement_by_twist(r) * twist_by_slip;
            const Matrix3d spread = moved * slips * moved.transpose();
            if (spread.trace() <= squared) continue;  // no larger than its trace
            const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(spread, Eigen::EigenvaluesOnly);
            squared = std::max(squared, eigen.eigenvalues()[2]);
        }
    }
    return std::sqrt(squared);
}

}  // namespace planlight
