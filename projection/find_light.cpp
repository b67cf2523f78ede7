#include "projection/find_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "planning_io/types/statistics.h"
#include "projection/bilinear.h"

namespace planlight {
namespace {

using Eigen::Vector2d;

constexpr double kStep_mm = 0.1;

/// Pixels a millimetre sideways makes across the stroke in the picture; 0 where it is not seen.
double across_px(const StrokePlace& place, const CameraModel& camera, const RigidTransform& rig_from_ct) {
    constexpr double kSmall_mm = 0.5;
    const auto here = project(camera, rig_from_ct * place.p_in_ct);
    const auto aside = project(camera, rig_from_ct * (place.p_in_ct + kSmall_mm * place.sideways_in_ct));
    const auto along = project(camera, rig_from_ct * (place.p_in_ct + kSmall_mm * place.along_in_ct));
    if (!here || !aside || !along) return 0;
    const Vector2d b = (*aside - *here) / kSmall_mm, t = (*along - *here).normalized();
    return std::abs(t.x() * b.y() - t.y() * b.x());
}

/// The mean of the places' profiles, from -search to +search; empty when a place is not wholly in the picture.
std::vector<double> mean_profile(const StrokeSegment& segment, const CameraModel& camera,
                                 const RigidTransform& rig_from_ct, const GrayImage& picture, double search_mm) {
    const int half = static_cast<int>(search_mm / kStep_mm);
    std::vector<double> profile(static_cast<std::size_t>(2 * half + 1), 0);
    for (const StrokePlace& place : segment.places) {
        // The way across is a parabola in the picture to a thousandth of a pixel: three of its points tell all.
        const auto at = [&](double mm) {
            return project(camera, rig_from_ct * (place.p_in_ct + mm * place.sideways_in_ct));
        };
        const double end_mm = half * kStep_mm;
        const auto middle = at(0), first = at(-end_mm), last = at(end_mm);
        if (!middle || !first || !last) return {};
        const Vector2d slope = (*last - *first) / 2, bend = (*last + *first) / 2 - *middle;
        for (int k = -half; k <= half; ++k) {
            const double share = static_cast<double>(k) / half;
            const auto grey = bilinear(picture, *middle + share * slope + share * share * bend);
            if (!grey) return {};
            profile[static_cast<std::size_t>(k + half)] += *grey / static_cast<double>(segment.places.size());
        }
    }
    return profile;
}

/// Without its straight part, which the light of the room leaves; gives the grey of that in the middle.
double level(std::vector<double>& profile) {
    const auto n = static_cast<double>(profile.size());
    const std::size_t part = profile.size() / 4;
    const double first =
        median(std::vector<double>(profile.begin(), profile.begin() + static_cast<std::ptrdiff_t>(part)));
    const double last = median(std::vector<double>(profile.end() - static_cast<std::ptrdiff_t>(part), profile.end()));
    const double slope = (last - first) / (n - static_cast<double>(part));
    for (std::size_t k = 0; k < profile.size(); ++k)
        profile[k] -= first + slope * (static_cast<double>(k) - static_cast<double>(part) / 2);
    return (first + last) / 2;
}

/// The profile filtered by a ridge of that sigma, less its surroundings (difference of Gaussians), in grey values of a
/// ridge that fits.
std::vector<double> matched(const std::vector<double>& profile, double sigma_mm) {
    const int reach = static_cast<int>(std::ceil(3 * 2 * sigma_mm / kStep_mm));
    std::vector<double> kernel(static_cast<std::size_t>(2 * reach + 1));
    double sum_fine = 0, sum_wide = 0;
    for (int k = -reach; k <= reach; ++k) {
        const double e = k * kStep_mm / sigma_mm;
        sum_fine += std::exp(-e * e / 2);
        sum_wide += std::exp(-e * e / 8);
    }
    for (int k = -reach; k <= reach; ++k) {
        const double e = k * kStep_mm / sigma_mm;
        kernel[static_cast<std::size_t>(k + reach)] = std::exp(-e * e / 2) / sum_fine - std::exp(-e * e / 8) / sum_wide;
    }
    std::vector<double> result(profile.size(), 0);
    const int n = static_cast<int>(profile.size());
    for (int i = 0; i < n; ++i)
        for (int k = -reach; k <= reach; ++k)
            result[static_cast<std::size_t>(i)] += kernel[static_cast<std::size_t>(k + reach)] *
                                                   profile[static_cast<std::size_t>(std::clamp(i + k, 0, n - 1))];
    return result;
}

/// What the filter makes of a ridge of that sigma and of height 1 at `off_mm`.
std::vector<double> response_of_ridge(double off_mm, double sigma_mm, std::size_t size) {
    std::vector<double> ridge(size);
    const double middle = static_cast<double>(size - 1) / 2;
    for (std::size_t k = 0; k < size; ++k) {
        const double e = ((static_cast<double>(k) - middle) * kStep_mm - off_mm) / sigma_mm;
        ridge[k] = std::exp(-e * e / 2);
    }
    return matched(ridge, sigma_mm);
}

/// Ink along the stroke, where a pen was led along the light: what the filter makes of a dark line has a bright one on
/// either side that is not there.
bool beside_a_darker_line(const std::vector<double>& response, std::size_t at) {
    constexpr double kInk_mm = 0.7, kBeside_mm = 0.6;
    const std::size_t middle = response.size() / 2,
                      reach = std::min(middle, static_cast<std::size_t>(kInk_mm / kStep_mm));
    if (std::abs(static_cast<double>(at) - static_cast<double>(middle)) * kStep_mm < kBeside_mm) return false;
    const auto first = response.begin() + static_cast<std::ptrdiff_t>(middle - reach);
    const auto last = response.begin() + static_cast<std::ptrdiff_t>(std::min(response.size(), middle + reach + 1));
    return -*std::min_element(first, last) > response[at];
}

/// The highest place of the response, and how much of the response one ridge there leaves unexplained: its noise.
std::optional<FoundLight> top_of(const std::vector<double>& response, double sigma_mm,
                                 const CheckLightSettings& settings) {
    const auto top = std::max_element(response.begin(), response.end());
    const auto at = static_cast<std::size_t>(top - response.begin());
    if (at == 0 || at + 1 == response.size()) return std::nullopt;
    if (beside_a_darker_line(response, at)) return std::nullopt;
    const double before = response[at - 1], after = response[at + 1];
    const double bend = before - 2 * *top + after;
    const double part = bend < 0 ? std::clamp((before - after) / (2 * bend), -0.5, 0.5) : 0;
    const double off_mm = (static_cast<double>(at) + part - static_cast<double>(response.size() - 1) / 2) * kStep_mm;
    const std::vector<double> ridge = response_of_ridge(off_mm, sigma_mm, response.size());
    std::vector<double> left;
    for (std::size_t k = 0; k < response.size(); ++k)
        left.push_back(std::abs(response[k] - *top / ridge[at] * ridge[k]));
    const double noise = std::max(1.4826 * median(std::move(left)), 0.02);
    if (*top < settings.least_peak_grey || *top < settings.least_peak_sigmas * noise) return std::nullopt;
    return FoundLight{off_mm, sigma_mm * noise / *top, *top, *top / ridge[at]};
}

}  // namespace

CameraLook find_light(const StrokeSegment& segment, const CameraModel& camera, const RigidTransform& rig_from_ct,
                      const GrayImage& picture, const CheckLightSettings& settings) {
    const StrokePlace& middle = segment.middle();
    const double px_per_mm = across_px(middle, camera, rig_from_ct);
    if (px_per_mm < settings.least_px_per_mm || picture.empty()) return {};
    std::vector<double> profile = mean_profile(segment, camera, rig_from_ct, picture, segment.search_mm);
    if (profile.empty()) return {};
    const double background = level(profile);
    const double sigma_mm = std::hypot(middle.width_mm / std::sqrt(12.0), 0.6 / px_per_mm, 0.2);
    CameraLook look{true, background, top_of(matched(profile, sigma_mm), sigma_mm, settings)};
    if (look.light)  // the ridge's light, gathered on the stroke's width
        look.light->brighter *=
            sigma_mm * std::sqrt(2 * std::numbers::pi) / middle.width_mm / std::max(background, 1.0);
    return look;
}

}  // namespace planlight
