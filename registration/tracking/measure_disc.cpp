#include "registration/tracking/measure_disc.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace planlight {
namespace {

constexpr int kRays = 36;
constexpr double kStepPx = 0.5;

/// Brightness between the pixels (bilinear); negative outside the picture.
double brightness(const GrayImage& picture, const Eigen::Vector2d& at) {
    const double fx = std::floor(at.x()), fy = std::floor(at.y());
    if (!(fx >= 0 && fy >= 0 && fx < picture.width - 1 && fy < picture.height - 1)) return -1;
    const std::uint8_t* p = picture.pixels.data() + picture.index(static_cast<int>(fx), static_cast<int>(fy));
    const double x = at.x() - fx, y = at.y() - fy;
    const double top = p[0] + x * (p[1] - p[0]);
    const double bottom = p[picture.width] + x * (p[picture.width + 1] - p[picture.width]);
    return top + y * (bottom - top);
}

Eigen::Vector2d direction(int ray) {
    const double angle = 2 * std::numbers::pi * ray / kRays;
    return {std::cos(angle), std::sin(angle)};
}

/// The first clear rise of brightness along a ray, as a fraction of `reach` (pixels, the ellipse's radius this way).
std::optional<double> first_rise(const GrayImage& picture, const Eigen::Vector2d& centre, const Eigen::Vector2d& reach,
                                 double from, double to, double min_rise) {
    constexpr int kMost = 512;
    std::array<double, kMost> value, rise;
    const double length = reach.norm();
    const Eigen::Vector2d step = reach / length * kStepPx;
    const int first = std::max(0, static_cast<int>(from * length / kStepPx) - 2);
    const int count = std::min(kMost, static_cast<int>(to * length / kStepPx) + 3 - first);
    if (count < 8) return std::nullopt;
    for (int i = 0; i < count; ++i) {
        value[static_cast<std::size_t>(i)] = brightness(picture, centre + (first + i) * step);
        if (value[static_cast<std::size_t>(i)] < 0) return std::nullopt;
    }
    double greatest = 0;
    for (int i = 2; i < count - 2; ++i) {
        const auto k = static_cast<std::size_t>(i);
        rise[k] = 0.5 * (value[k + 1] + value[k + 2] - value[k - 1] - value[k - 2]);
        greatest = std::max(greatest, rise[k]);
    }
    if (greatest < min_rise) return std::nullopt;
    for (int i = 3; i < count - 3; ++i) {
        const auto k = static_cast<std::size_t>(i);
        if (rise[k] < 0.5 * greatest || rise[k] < rise[k - 1] || rise[k] < rise[k + 1]) continue;
        const double bend = rise[k - 1] - 2 * rise[k] + rise[k + 1];
        const double shift = bend < 0 ? 0.5 * (rise[k - 1] - rise[k + 1]) / bend : 0;
        return (first + i + shift) * kStepPx / length;
    }
    return std::nullopt;
}

/// The ellipse through the edge seen along the rays of `rough`; empty when fewer than `min_fraction` of them agree on
/// one.
std::optional<Ellipse> ellipse_from_rays(const GrayImage& picture, const Ellipse& rough, double from, double to,
                                         double min_rise, double min_fraction, std::vector<Eigen::Vector2d>& edge) {
    const Eigen::Matrix2d L = rough.from_unit_circle();
    edge.clear();
    for (int ray = 0; ray < kRays; ++ray) {
        const Eigen::Vector2d reach = L * direction(ray);
        if (const auto s = first_rise(picture, rough.centre, reach, from, to, min_rise))
            edge.push_back(rough.centre + *s * reach);
        if (static_cast<double>(edge.size()) + (kRays - 1 - ray) < min_fraction * kRays) return std::nullopt;
    }
    std::vector<bool> used;
    const auto ellipse = fit_ellipse_to_points(edge, used);
    if (!ellipse || static_cast<double>(std::count(used.begin(), used.end(), true)) < min_fraction * kRays)
        return std::nullopt;
    return ellipse;
}

/// Root mean square of the distances of the edge points to the ellipse, the worst eighth left out.
double trimmed_residual(const Ellipse& ellipse, const std::vector<Eigen::Vector2d>& edge) {
    std::vector<double> squares;
    for (const auto& p : edge) squares.push_back(std::pow(ellipse.distance(p), 2));
    std::sort(squares.begin(), squares.end());
    const std::size_t kept = std::max<std::size_t>(1, squares.size() - squares.size() / 8);
    double sum = 0;
    for (std::size_t i = 0; i < kept; ++i) sum += squares[i];
    return std::sqrt(sum / static_cast<double>(kept));
}

double median(std::array<double, kRays> values) {
    std::nth_element(values.begin(), values.begin() + kRays / 2, values.end());
    return values[kRays / 2];
}

/// Standard deviation of the noise inside the disc, grey values, from second differences (which shading does not
/// reach).
double noise_inside(const GrayImage& picture, const Ellipse& disc) {
    const double reach = 0.5 * disc.half_axes().y();
    const int x0 = static_cast<int>(disc.centre.x() - reach), x1 = static_cast<int>(disc.centre.x() + reach);
    const int y0 = static_cast<int>(disc.centre.y() - reach), y1 = static_cast<int>(disc.centre.y() + reach);
    double sum = 0;
    int count = 0;
    for (int y = std::max(0, y0); y <= std::min(y1, picture.height - 1); ++y)
        for (int x = std::max(1, x0); x <= std::min(x1, picture.width - 2); ++x, ++count)
            sum += std::pow(picture.at(x - 1, y) - 2 * picture.at(x, y) + picture.at(x + 1, y), 2);
    return count > 0 ? std::sqrt(sum / (6 * count)) : 0;
}

/// The shift of a tilted circle's centre under perspective (r^2 sin cos / depth, for a disc of 4 mm radius at 0.9 m).
double perspective_px(double radius_px, double axis_ratio) {
    return 4 / 900. * radius_px * axis_ratio * std::sqrt(1 - axis_ratio * axis_ratio);
}

/// One standard deviation of the centre by the noise over the slope of the edge, averaged round it.
double noise_sigma_px(double radius_px, double axis_ratio, double noise, double contrast) {
    constexpr double kEdgeWidthPx = 2;  // contrast / slope of an edge blurred by 0.8 px
    const double edge_sigma_px = kEdgeWidthPx * std::max(0.5, noise) / contrast;
    return std::hypot(1.2 * edge_sigma_px / std::sqrt(std::numbers::pi * radius_px * axis_ratio), 0.004);
}

/// Grey values from the disc to its ring, when both look like a marker's all round; empty otherwise.
std::optional<double> ring_contrast(const GrayImage& picture, const Ellipse& disc, const MarkerSettings& settings) {
    const Eigen::Matrix2d L = disc.from_unit_circle();
    std::array<double, kRays> inside, ring, outside;
    for (int ray = 0; ray < kRays; ++ray) {
        const auto k = static_cast<std::size_t>(ray);
        const Eigen::Vector2d reach = L * direction(ray);
        inside[k] = brightness(picture, disc.centre + 0.5 * reach);
        ring[k] = brightness(picture, disc.centre + 0.5 * (1 + settings.sticker_ratio) * reach);
        outside[k] = brightness(picture, disc.centre + (settings.sticker_ratio + 0.5) * reach);
        if (inside[k] < 0 || ring[k] < 0) return std::nullopt;
    }
    const double dark = median(inside), contrast = median(ring) - dark;
    if (contrast < settings.min_contrast) return std::nullopt;
    int dark_inside = 0, bright_ring = 0, darker_outside = 0, skin_outside = 0, outside_seen = 0;
    for (std::size_t k = 0; k < kRays; ++k) {
        dark_inside += inside[k] < dark + 0.4 * contrast;
        bright_ring += ring[k] > dark + 0.6 * contrast;
        if (outside[k] < 0) continue;
        ++outside_seen;
        darker_outside += outside[k] < ring[k] - settings.min_ring_step * contrast;
        skin_outside += outside[k] > dark + 0.08 * contrast;
    }
    // A circle of light on the skin is as dark inside as outside; round a marker at most a part is the dark background.
    if (skin_outside < 0.4 * outside_seen) return std::nullopt;
    if (dark_inside < 0.9 * kRays || bright_ring < 0.9 * kRays || darker_outside < 0.6 * outside_seen)
        return std::nullopt;
    return contrast;
}

}  // namespace

std::optional<MarkerObservation> measure_disc(const GrayImage& picture, const Ellipse& rough,
                                              const MarkerSettings& settings) {
    std::vector<Eigen::Vector2d> edge;
    const double min_rise = 0.6 * settings.min_contrast;
    auto ellipse = ellipse_from_rays(picture, rough, 0.3, 1.9, min_rise, 0.6, edge);
    if (ellipse) ellipse = ellipse_from_rays(picture, *ellipse, 0.55, 1.5, min_rise, 0.8, edge);
    if (!ellipse) return std::nullopt;
    const Eigen::Vector2d axes = ellipse->half_axes();
    if (axes.y() < settings.min_axis_ratio * axes.x() || axes.mean() < settings.min_radius_px ||
        axes.mean() > settings.max_radius_px)
        return std::nullopt;
    const double half_width = std::clamp(0.45 * axes.y(), 1.5, 3.0);
    const auto fit = fit_ellipse_to_gradients(picture, *ellipse, half_width);
    if (!fit || (fit->centre - ellipse->centre).norm() > 0.5 + 0.02 * axes.x()) return std::nullopt;
    if (trimmed_residual(*fit, edge) > std::max(settings.max_fit_residual_px, settings.max_bend * axes.mean()))
        return std::nullopt;
    const auto contrast = ring_contrast(picture, *fit, settings);
    if (!contrast) return std::nullopt;
    const Eigen::Vector2d fitted = fit->half_axes();
    const double ratio = fitted.y() / fitted.x();
    const double steady = perspective_px(fitted.mean(), ratio);
    const double sigma =
        std::hypot(noise_sigma_px(fitted.mean(), ratio, noise_inside(picture, *fit), *contrast), steady);
    return MarkerObservation{fit->centre, fitted.mean(), ratio, sigma, steady, *contrast};
}

}  // namespace planlight
