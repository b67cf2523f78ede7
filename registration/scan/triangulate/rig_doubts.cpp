#include "registration/scan/triangulate/rig_doubts.h"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace planlight {
namespace {

constexpr Eigen::Index kModes = 3;

/// The places that settle, with their points where this rig sees them.
std::vector<SeenPlace> seen_by(const RigCalibration& rig, const std::vector<SeenPlace>& places) {
    std::vector<SeenPlace> seen;
    for (const SeenPlace& place : places)
        if (const auto p = point_of_pixels(rig, place.pixels, place.p_in_rig)) seen.push_back({place.pixels, *p});
    return seen;
}

/// How the points of all places move when they are seen by another rig; one below the other.
Eigen::VectorXd moves_of(const RigCalibration& other, const std::vector<SeenPlace>& seen) {
    Eigen::VectorXd moves = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(seen.size()));
    for (std::size_t i = 0; i < seen.size(); ++i)
        if (const auto p = point_of_pixels(other, seen[i].pixels, seen[i].p_in_rig))
            moves.segment<3>(3 * static_cast<Eigen::Index>(i)) = *p - seen[i].p_in_rig;
    return moves;
}

/// Takes a common turn and shift out of every column: a match does so as well.
void remove_common_motion(const std::vector<SeenPlace>& seen, Eigen::MatrixXd& moves) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const SeenPlace& place : seen) middle += place.p_in_rig / static_cast<double>(seen.size());
    Eigen::MatrixXd common(moves.rows(), 6);
    constexpr double kArm_mm = 100;  // turns in units like the shifts'
    for (std::size_t i = 0; i < seen.size(); ++i)
        common.middleRows<3>(3 * static_cast<Eigen::Index>(i)) =
            movement_by_twist((seen[i].p_in_rig - middle) / kArm_mm);
    moves -= common * (common.transpose() * common).ldlt().solve(common.transpose() * moves);
}

}  // namespace

RigDoubt doubt_between(const RigCalibration& used, const RigCalibration& other, const std::vector<SeenPlace>& places) {
    std::vector<Eigen::Vector3d> here, there;
    for (const SeenPlace& place : places) {
        const auto a = point_of_pixels(used, place.pixels, place.p_in_rig),
                   b = point_of_pixels(other, place.pixels, place.p_in_rig);
        if (a && b) here.push_back(*a), there.push_back(*b);
    }
    RigDoubt doubt;
    for (auto& by : doubt.by) by.setZero();
    if (here.size() < 6) return doubt;
    const auto columns = [](const std::vector<Eigen::Vector3d>& points) {
        return Eigen::Matrix3Xd(
            Eigen::Map<const Eigen::Matrix3Xd>(points.front().data(), 3, static_cast<Eigen::Index>(points.size())));
    };
    const RigidTransform there_from_here = fit_rigid_transform(columns(here), columns(there));
    for (std::size_t d = 0; d < kRigDevices; ++d) {
        const CameraModel &a = device_of(used, static_cast<RigDevice>(d)),
                          &b = device_of(other, static_cast<RigDevice>(d));
        const RigidTransform step = b.device_from_rig * there_from_here * a.device_from_rig.inverse();
        doubt.by[d] << rotation_vector(step.linear()), step.translation(), std::log(b.focal_x / a.focal_x),
            b.centre_x - a.centre_x, b.centre_y - a.centre_y, b.k1 - a.k1;
    }
    return doubt;
}

std::vector<RigDoubt> own_doubts(const Explanation& explanation, const RigCalibration& used,
                                 const std::vector<SeenPlace>& places) {
    const Eigen::LLT<RigMatrix> root(explanation.covariance + 1e-18 * RigMatrix::Identity());
    if (root.info() != Eigen::Success) return {};
    const RigMatrix L = root.matrixL();
    const std::vector<SeenPlace> seen = seen_by(used, places);
    Eigen::MatrixXd moves(3 * static_cast<Eigen::Index>(seen.size()), kRigNumbers);
    tbb::parallel_for(Eigen::Index{0}, Eigen::Index{kRigNumbers},
                      [&](Eigen::Index k) { moves.col(k) = moves_of(changed(used, RigNumbers(L.col(k))), seen); });
    remove_common_motion(seen, moves);
    const RigMatrix squares = moves.transpose() * moves;
    const Eigen::SelfAdjointEigenSolver<RigMatrix> axes(squares);  // ascending
    std::vector<RigDoubt> doubts;
    for (Eigen::Index k = 0; k < kModes; ++k) {
        const RigNumbers numbers = L * axes.eigenvectors().col(kRigNumbers - 1 - k);
        RigDoubt doubt = doubt_between(used, changed(used, numbers), places);
        doubt.sigma = true;
        doubt.what = "what the calibration and this scan leave open";
        doubts.push_back(doubt);
    }
    return doubts;
}

double hidden_over(const RigState& state, const std::vector<SeenPlace>& places) {
    std::vector<double> hidden;
    for (const SeenPlace& place : places)
        if (const auto p = point_of_pixels(state.rig, place.pixels, place.p_in_rig))
            hidden.push_back(hidden_light_mm(state, *p));
    if (hidden.empty()) return 0;
    const auto rank = hidden.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(hidden.size() - 1));
    std::nth_element(hidden.begin(), rank, hidden.end());
    return *rank;
}

}  // namespace planlight
