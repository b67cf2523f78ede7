#include "registration/scan/triangulate/triangulate_parts.h"
#include "planning_io/types/statistics.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace planlight {
namespace {

/// A sample of the points that the cameras placed, evenly along the list.
void keep_by_cameras(const std::vector<PointOutcome>& outcomes, std::size_t count, Triangulation& result) {
    constexpr std::size_t kSample = 20000;
    const std::size_t every = 1 + count / kSample;
    std::size_t seen = 0;
    for (const PointOutcome& o : outcomes) {
        if (!o.placed_by_cameras || seen++ % every != 0) continue;
        result.by_cameras.push_back({o.p_by_cameras, o.pixel_in_projector, o.epipolar_px});
    }
}

void collect_evidence(const std::vector<PointOutcome>& outcomes, Triangulation& result) {
    std::vector<double> du, dv;
    double squares = 0;
    for (const PointOutcome& o : outcomes) {
        if (!o.placed_by_cameras) continue;
        du.push_back(o.projector_offset_px.x());
        dv.push_back(o.projector_offset_px.y());
        squares += o.epipolar_px * o.epipolar_px;
    }
    if (du.empty()) return;
    keep_by_cameras(outcomes, du.size(), result);
    result.epipolar_rms_px = std::sqrt(squares / static_cast<double>(du.size()));
    result.projector_offset_px = {median(std::move(du)), median(std::move(dv))};
}

}  // namespace

double worst_sigma(const Eigen::Matrix3d& covariance) {
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(covariance, Eigen::EigenvaluesOnly);
    return std::sqrt(std::max(0.0, solver.eigenvalues()(2)));
}

bool in_volume(const CameraModel& projector, const Eigen::Vector3d& p_in_rig, const TriangulationSettings& settings) {
    const double distance = (projector.device_from_rig * p_in_rig).norm();
    return distance >= settings.near_mm && distance <= settings.far_mm;
}

Stride stride_for(std::size_t decoded, const TriangulationSettings& settings) {
    constexpr std::size_t kMaxPoints = 75000;
    if (settings.stride > 0) return {settings.stride, settings.stride};
    Stride stride;
    while (decoded > kMaxPoints * static_cast<std::size_t>(stride.x * stride.y))
        (stride.x < stride.y ? stride.x : stride.y)++;
    return stride;
}

void collect(const std::vector<PointOutcome>& outcomes, Triangulation& result) {
    using Kind = PointOutcome::Kind;
    for (const PointOutcome& o : outcomes) {
        if (o.kind == Kind::no_partner) ++result.no_partner;
        if (o.kind == Kind::ragged) ++result.ragged;
        if (o.kind == Kind::disagree) ++result.disagree;
        if (o.kind == Kind::outside_volume) ++result.outside_volume;
        if (o.kind != Kind::point) continue;
        ++(o.seen == Triangulation::Seen::both ? result.three_view : result.two_view);
        result.cloud.points_in_rig.push_back(o.p_in_rig);
        result.cloud.sigma_mm.push_back(static_cast<float>(o.sigma_mm));
        result.cloud.pixels_in_projector.push_back(o.pixel_in_projector);
        result.grid.emplace_back(static_cast<int>(std::lround(o.pixel_in_projector.x())),
                                 static_cast<int>(std::lround(o.pixel_in_projector.y())));
        result.seen.push_back(o.seen);
    }
    collect_evidence(outcomes, result);
}

}  // namespace planlight
