#include "registration/scan/movement/scan_movement.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "planning_io/types/statistics.h"
#include "registration/scan/check/camera_gamma.h"
#include "registration/scan/movement/affine_movement.h"

namespace planlight {
namespace {

using affine_movement::Laid;
using affine_movement::Moment;
using affine_movement::Pictures;
using affine_movement::Surface;
using Kind = StripePattern::Kind;

struct NamedMoment {
    std::string name;
    double when = 0;
    Moment moment;
};

/// Every even picture, and every bit without an inverse by what is lit in it.
std::vector<NamedMoment> moments_of(const ScanCapture& capture, const std::vector<UniformLightFrame>& even) {
    std::vector<NamedMoment> moments;
    for (const UniformLightFrame& moment : even) moments.push_back({moment.name, moment.when, {moment.frames, false}});
    // Light spreads under the skin: where fringes show the end of the sequence, bits are looked at far from their
    // edges.
    const int clear_px = even.size() > 1 ? 9 : 4;
    const auto patterns = capture.partial.empty() ? stripe_sequence(capture.stripes) : capture.partial;
    for (std::size_t i = 0; i < patterns.size(); ++i) {
        if (patterns[i].kind != Kind::gray_bit) continue;
        if (i + 1 < patterns.size() && patterns[i + 1].kind == Kind::gray_bit_inverse) continue;
        moments.push_back(
            {patterns[i].name, static_cast<double>(i) / static_cast<double>(patterns.size()), {{i}, true, clear_px}});
    }
    std::stable_sort(moments.begin(), moments.end(), [](const auto& a, const auto& b) { return a.when < b.when; });
    return moments;
}

Pictures pictures_of(const std::vector<GrayImage>& frames, double gamma) {
    Pictures pictures{frames, 0, 1, {}};
    for (std::size_t g = 0; g < pictures.light.size(); ++g)
        pictures.light[g] = static_cast<float>(255 * std::pow(static_cast<double>(g) / 255, gamma));
    return pictures;
}

/// The greatest way between two of the moments that is more than the measurement's own scatter (two sigma).
void find_greatest(const std::vector<NamedMoment>& moments, const std::vector<Laid>& laid, const Surface& surface,
                   double mm_per_px, ScanMovement& movement) {
    std::vector<double> sigmas_mm;
    for (std::size_t i = 0; i < laid.size(); ++i)
        for (std::size_t j = i + 1; j < laid.size(); ++j) {
            if (!laid[i].determined || !laid[j].determined) continue;
            const auto way = surface.between(laid[i], laid[j]);
            if (!way) continue;
            const auto [way_px, sigma_px] = *way;
            sigmas_mm.push_back(mm_per_px * sigma_px);
            const double moved_mm = mm_per_px * std::sqrt(std::max(0.0, way_px * way_px - 4 * sigma_px * sigma_px));
            if (moved_mm <= movement.moved_mm) continue;
            movement.moved_mm = moved_mm;
            movement.from = moments[i].name;
            movement.to = moments[j].name;
        }
    if (sigmas_mm.empty()) return;
    movement.by = ScanMovement::By::pictures;
    movement.sigma_mm = median(sigmas_mm);
}

/// How much the light changed, as a share of the projector's. The sum of fringes is as bright as the projector's grey
/// values make it (0.36 of white at a gamma of 2.2, and not a half): it is compared with that of other fringes only.
double change_of_light(const std::vector<Moment>& moments, const std::vector<Laid>& laid) {
    double change = 0;
    for (const bool fringes : {false, true}) {
        double least = std::numeric_limits<double>::infinity(), most = -least;
        for (std::size_t i = 0; i < moments.size(); ++i) {
            if (!laid[i].determined || (moments[i].frames.size() > 2) != fringes) continue;
            // (Of many fringes each by itself is known too badly.)
            if (!fringes) change = std::max(change, laid[i].uneven_light);
            least = std::min(least, laid[i].light_change);
            most = std::max(most, laid[i].light_change);
        }
        change = std::max(change, most - least);  // minus infinity where there are none
    }
    return change;
}

ScanMovement seen_by(const std::vector<GrayImage>& frames, const std::vector<UniformLightFrame>& even,
                     const std::vector<NamedMoment>& named, double mm_per_px) {
    ScanMovement movement;
    const double gamma = camera_gamma(frames, even);
    const Pictures pictures = pictures_of(frames, gamma);
    std::vector<Moment> moments;
    for (const NamedMoment& moment : named) moments.push_back(moment.moment);
    const Surface surface(pictures, moments.front(), moments);
    if (!surface.enough() || moments.size() < 2) return movement;
    std::vector<Laid> laid(moments.size());
    tbb::parallel_for(std::size_t{0}, moments.size(),
                      [&](std::size_t i) { laid[i] = surface.lay(surface.steadied(moments[i])); });
    movement.moments =
        static_cast<int>(std::count_if(laid.begin(), laid.end(), [](const Laid& l) { return l.determined; }));
    movement.light_change = change_of_light(moments, laid);
    movement.camera_gamma = gamma;
    find_greatest(named, laid, surface, mm_per_px, movement);
    return movement;
}

}  // namespace

ScanMovement movement_in_pictures(const ScanCapture& capture, double left_mm_per_px, double right_mm_per_px) {
    ScanMovement movement;
    const auto even = uniform_light_frames(capture);
    if (even.empty() || even.front().name != "white") return movement;
    const std::vector<NamedMoment> named = moments_of(capture, even);
    if (!capture.left.empty()) movement = seen_by(capture.left, even, named, left_mm_per_px);
    if (capture.right.empty() || right_mm_per_px <= 0) return movement;
    ScanMovement other = seen_by(capture.right, even, named, right_mm_per_px);
    if (other.by == ScanMovement::By::nothing) return movement;
    if (movement.by == ScanMovement::By::nothing) return other;
    const double sigma_mm = std::max(movement.sigma_mm, other.sigma_mm);
    if (other.moved_mm > movement.moved_mm) movement = std::move(other);
    movement.sigma_mm = sigma_mm;
    return movement;
}

double mm_per_pixel(const PointCloud& cloud, const CameraModel& camera) {
    std::vector<double> depths;
    if (camera.focal_x <= 0) return 0;
    for (const auto& p : cloud.points_in_rig) depths.push_back((camera.device_from_rig * p).z());
    if (depths.empty()) return 0;
    return median(depths) / camera.focal_x;
}

}  // namespace planlight
