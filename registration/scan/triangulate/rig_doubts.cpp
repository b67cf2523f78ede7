#include "registration/scan/triangulate/rig_doubts.h"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace planlight {
namespace {

constexpr Eigen::Index kModes = 3;

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
    const auto rows = 3 * static_cast<Eigen::Index>(places.size());
    Eigen::MatrixXd moves = Eigen::MatrixXd::Zero(rows, kRigNumbers);
    const auto move_of = [&](const RigNumbers& numbers) {
        const RigDoubt doubt = doubt_between(used, changed(used, numbers), places);
        const RigCalibration other = doubted(used, doubt);
        Eigen::VectorXd move = Eigen::VectorXd::Zero(rows);
        for (std::size_t i = 0; i < places.size(); ++i) {
            const auto p = point_of_pixels(other, places[i].pixels, places[i].p_in_rig);
            const auto q = point_of_pixels(used, places[i].pixels, places[i].p_in_rig);
            if (p && q) move.segment<3>(3 * static_cast<Eigen::Index>(i)) = *p - *q;
        }
        return move;
    };
    tbb::parallel_for(Eigen::Index{0}, Eigen::Index{kRigNumbers},
                      [&](Eigen::Index k) { moves.col(k) = move_of(L.col(k)); });
    const RigMatrix squares = moves.transpose() * moves;
    const Eigen::SelfAdjointEigenSolver<RigMatrix> axes(squares);  // ascending
    std::vector<RigDoubt> doubts;
    for (Eigen::Index k = 0; k < kModes; ++k) {
        RigDoubt doubt =
            doubt_between(used, changed(used, RigNumbers(L * axes.eigenvectors().col(kRigNumbers - 1 - k))), places);
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
