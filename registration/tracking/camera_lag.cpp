#include "registration/tracking/camera_lag.h"

#include <algorithm>
#include <cmath>

#include "planning_io/types/camera_model.h"
#include "planning_io/types/statistics.h"
#include "registration/tracking/pair_markers.h"

namespace planlight {
namespace {

constexpr double kAlongRay_mm = 5;  // to either side, for the direction of an epipolar line

const MarkerObservation* seen_as(const std::vector<PatientTracker::Seen>& seen, int marker) {
    for (const auto& s : seen)
        if (s.marker == marker) return &s.left_or_right;
    return nullptr;
}

}  // namespace

void CameraLag::add(const PatientTracker& tracker, Instant at) {
    const std::size_t frame = frames_++;
    for (const auto& seen : tracker.seen_left()) {
        const MarkerObservation* right = seen.marker < 0 ? nullptr : seen_as(tracker.seen_right(), seen.marker);
        if (!right) continue;
        const auto place = triangulate_marker(rig_, seen.left_or_right, *right);
        const auto ray = ray_through(rig_.left_camera, seen.left_or_right.pixel);
        if (!place || !ray) continue;
        const double along = (place->point_in_rig - ray->origin).dot(ray->direction);
        const auto on_ray = [&](double mm) { return project(rig_.right_camera, ray->origin + mm * ray->direction); };
        const auto here = on_ray(along), nearer = on_ray(along - kAlongRay_mm), farther = on_ray(along + kAlongRay_mm);
        if (!here || !nearer || !farther) continue;
        const Eigen::Vector2d line = *farther - *nearer;
        if (!(line.norm() > 0)) continue;
        const Eigen::Vector2d across = Eigen::Vector2d(-line.y(), line.x()).normalized();
        of_marker_[seen.marker].push_back(
            {frame, seconds(at), (right->pixel - *here).dot(across), right->pixel, across});
    }
}

std::vector<std::vector<CameraLag::Sight>> CameraLag::sights_without_usual() const {
    std::vector<std::vector<Sight>> all;
    for (const auto& [marker, sights] : of_marker_) {
        std::vector<double> parallaxes;
        for (const Sight& s : sights) parallaxes.push_back(s.parallax_px);
        const double usual = median(std::move(parallaxes));
        all.push_back(sights);
        for (Sight& s : all.back()) s.parallax_px -= usual;
    }
    return all;
}

CameraLag::Lag CameraLag::lag() const {
    constexpr std::size_t kLeast = 8;
    constexpr double kLeastWay_px = 0.25;  // across the lines between two frames, rms: slower is too slow to tell
    std::vector<std::pair<double, double>> by_speed;  // pixels a second across the line, parallax
    double way = 0;
    for (const auto& sights : sights_without_usual())
        for (std::size_t i = 1; i + 1 < sights.size(); ++i) {
            const Sight &before = sights[i - 1], &here = sights[i], &after = sights[i + 1];
            if (after.frame - before.frame != 2) continue;
            const double moved_px = (after.pixel_in_right - before.pixel_in_right).dot(here.across);
            way += moved_px * moved_px / 4;
            by_speed.emplace_back(moved_px / (after.at_s - before.at_s), here.parallax_px);
        }
    Lag lag;
    if (by_speed.size() < kLeast || way < kLeastWay_px * kLeastWay_px * static_cast<double>(by_speed.size()))
        return lag;
    double speed = 0, parallax = 0;
    for (const auto& [v, d] : by_speed) speed += v, parallax += d;
    const auto n = static_cast<double>(by_speed.size());
    speed /= n, parallax /= n;
    double vv = 0, vd = 0, rest = 0;
    for (const auto& [v, d] : by_speed) vv += (v - speed) * (v - speed), vd += (v - speed) * (d - parallax);
    if (!(vv > 0)) return lag;
    lag.right_later_s = vd / vv;
    for (const auto& [v, d] : by_speed) rest += std::pow(d - parallax - lag.right_later_s * (v - speed), 2);
    lag.sigma_s = std::sqrt(rest / (n - 2) / vv);
    lag.known = true;
    return lag;
}

std::vector<std::size_t> CameraLag::odd_frames() const {
    constexpr double kLeast_px = 0.2, kSigmas = 6;
    if (frames_ < 5) return {};
    std::vector<std::vector<double>> of_frame(frames_);
    for (const auto& sights : sights_without_usual())
        for (const Sight& s : sights) of_frame[s.frame].push_back(s.parallax_px);
    std::vector<double> middles(frames_, 0), sizes;
    for (std::size_t f = 0; f < frames_; ++f)
        if (of_frame[f].size() >= 3) {
            middles[f] = median(of_frame[f]);
            sizes.push_back(std::abs(middles[f]));
        }
    if (sizes.size() < 5) return {};
    const double limit = std::max(kLeast_px, kSigmas * 1.4826 * median(std::move(sizes)));
    std::vector<std::size_t> odd;
    for (std::size_t f = 0; f < frames_; ++f)
        if (std::abs(middles[f]) > limit) odd.push_back(f);
    return odd;
}

}  // namespace planlight
