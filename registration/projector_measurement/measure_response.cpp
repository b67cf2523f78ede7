#include "registration/projector_measurement/measure_response.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "registration/projector_measurement/fit_response.h"

namespace planlight {
namespace {

/// Mean and standard deviation of the mean of one order's frames.
struct Shown {
    double at_s = 0, grey = 0, sigma = 0;
    std::size_t frames = 0;
};

/// Noise of a frame's mean: of the camera, the same for all, and of the light, which grows with it (a colour wheel).
class FrameNoise {
public:
    FrameNoise(const std::vector<Shown>& all, const std::vector<std::pair<double, double>>& spreads) {
        double white = 0;
        black_ = 1e9;
        for (const Shown& shown : all)
            if (shown.frames > 0) black_ = std::min(black_, shown.grey), white = std::max(white, shown.grey);
        double dark = 0, dark_freedom = 0, lit = 0, lit_freedom = 0;
        for (std::size_t i = 0; i < all.size(); ++i)
            if (all[i].grey - black_ < 0.15 * (white - black_))
                dark += spreads[i].first, dark_freedom += spreads[i].second;
        camera_ = dark_freedom > 0 ? std::max(kLeast_grey * kLeast_grey, dark / dark_freedom) : 0.05 * 0.05;
        for (std::size_t i = 0; i < all.size(); ++i) {
            const double light = all[i].grey - black_;
            if (all[i].frames == 0 || light < 0.15 * (white - black_)) continue;
            lit += (spreads[i].first - camera_ * spreads[i].second) / (light * light), lit_freedom += spreads[i].second;
        }
        of_light_ = lit_freedom > 0 ? std::max(0.0, lit / lit_freedom) : 0;
    }
    double at(double grey) const { return std::sqrt(camera_ + of_light_ * (grey - black_) * (grey - black_)); }

private:
    static constexpr double kLeast_grey = 0.005;
    double black_ = 0, camera_ = 0, of_light_ = 0;
};

/// Brightness of every order over some tiles.
std::vector<Shown> shown_by_order(const LightRecording& recording, const std::vector<std::size_t>& tiles) {
    std::vector<Shown> all(recording.orders.size());
    const auto steady = steady_frames(recording);
    std::vector<std::pair<double, double>> spreads;  // sum of squares about the order's mean, frames less one
    for (std::size_t o = 0; o < all.size(); ++o) {
        Shown& shown = all[o];
        std::vector<double> values;
        for (const std::size_t f : steady[o]) {
            values.push_back(mean_of(recording.frames[f], tiles));
            shown.grey += values.back();
            shown.at_s += seconds(recording.frames[f].at);
        }
        shown.frames = values.size();
        spreads.emplace_back(0, 0);
        if (values.empty()) continue;
        shown.grey /= static_cast<double>(values.size());
        shown.at_s /= static_cast<double>(values.size());
        for (const double v : values) spreads.back().first += (v - shown.grey) * (v - shown.grey);
        spreads.back().second = static_cast<double>(values.size()) - 1;
    }
    const FrameNoise noise(all, spreads);
    for (Shown& shown : all)
        if (shown.frames > 0) shown.sigma = noise.at(shown.grey) / std::sqrt(static_cast<double>(shown.frames));
    return all;
}

/// Black or white at any moment: straight between the references, level beyond them.
class Reference {
public:
    Reference(const LightRecording& recording, const std::vector<Shown>& shown, Rgb colour) {
        for (std::size_t o = 0; o < shown.size(); ++o)
            if (recording.orders[o].colour == colour && !recording.orders[o].covered && shown[o].frames > 0)
                points_.emplace_back(shown[o].at_s, shown[o].grey), sigma_ = std::max(sigma_, shown[o].sigma);
    }
    double sigma() const { return sigma_; }
    double at(double at_s) const {
        const auto next = std::find_if(points_.begin(), points_.end(), [&](const auto& p) { return p.first >= at_s; });
        if (next == points_.end()) return points_.back().second;
        if (next == points_.begin()) return next->second;
        const auto before = std::prev(next);
        const double part = (at_s - before->first) / (next->first - before->first);
        return before->second + part * (next->second - before->second);
    }
    double mean() const {
        double sum = 0;
        for (const auto& p : points_) sum += p.second;
        return sum / static_cast<double>(points_.size());
    }
    double worst_from_mean() const {
        double worst = 0;
        for (const auto& p : points_) worst = std::max(worst, std::abs(p.second - mean()));
        return worst;
    }

private:
    std::vector<std::pair<double, double>> points_;
    double sigma_ = 0;
};

struct Measured {
    std::vector<ResponsePoint> curve;
    double black = 0, white = 0, drift = 0;
    std::map<Rgb, ResponsePoint> colours;
    std::optional<std::pair<double, double>> covered;  ///< grey, sigma
    double black_sigma = 0;
};

Measured measured_on(const LightRecording& recording, const std::vector<std::size_t>& tiles) {
    const auto shown = shown_by_order(recording, tiles);
    const Reference black(recording, shown, {0, 0, 0}), white(recording, shown, {255, 255, 255});
    Measured result;
    result.black = black.mean();
    result.white = white.mean();
    result.drift = std::max(0.0, white.worst_from_mean() - 3 * white.sigma()) / (result.white - result.black);
    struct Sum {
        double light = 0, square = 0, sigma_square = 0;
        std::size_t orders = 0, frames = 0;
    };
    std::map<Rgb, Sum> sums;
    double black_square = 0;
    std::size_t blacks = 0;
    for (std::size_t o = 0; o < shown.size(); ++o) {
        if (shown[o].frames == 0) continue;
        if (recording.orders[o].covered) {
            result.covered = {shown[o].grey, shown[o].sigma};
            continue;
        }
        const double b = black.at(shown[o].at_s), w = white.at(shown[o].at_s);
        const double light = (shown[o].grey - b) / (w - b);
        Sum& sum = sums[recording.orders[o].colour];
        sum.light += light, sum.square += light * light, ++sum.orders, sum.frames += shown[o].frames;
        const double noise = std::hypot(shown[o].sigma, light * white.sigma(), (1 - light) * black.sigma()) / (w - b);
        sum.sigma_square += noise * noise;
        if (recording.orders[o].colour == Rgb{0, 0, 0}) black_square += shown[o].sigma * shown[o].sigma, ++blacks;
    }
    if (blacks > 0) result.black_sigma = std::sqrt(black_square) / static_cast<double>(blacks);
    for (const auto& [colour, sum] : sums) {
        const auto n = static_cast<double>(sum.orders);
        ResponsePoint point;
        point.light = sum.light / n;
        const double between =
            sum.orders > 1 ? std::max(0.0, sum.square - n * point.light * point.light) / (n - 1) / n : 0;
        point.sigma = std::max(std::sqrt(sum.sigma_square) / n, std::sqrt(between));
        point.frames = sum.frames;
        point.grey = colour[0];
        if (colour[0] == colour[1] && colour[1] == colour[2])
            result.curve.push_back(point);
        else
            result.colours[colour] = point;
    }
    // What the references are set against is themselves.
    if (!result.curve.empty() && result.curve.front().grey == 0) result.curve.front().light = 0;
    if (!result.curve.empty() && result.curve.back().grey == 255) result.curve.back().light = 1;
    return result;
}

double largest_difference(const std::vector<ResponsePoint>& a, const std::vector<ResponsePoint>& b) {
    double worst = 0;
    for (std::size_t i = 0; i < a.size() && i < b.size(); ++i)
        worst = std::max(worst, std::abs(a[i].light - b[i].light) - 3 * std::hypot(a[i].sigma, b[i].sigma));
    return worst;
}

}  // namespace

ResponseResult measure_response(const LightRecording& recording) {
    ResponseResult result;
    const LitTiles lit = find_lit_tiles(recording);
    if (lit.refusal) {
        result.refusal = lit.refusal;
        return result;
    }
    const Measured both = measured_on(recording, lit.tiles);
    result.curve = both.curve;
    constexpr std::size_t kLeastGreys = 8;
    if (result.curve.size() < kLeastGreys) {
        result.refusal = {
            fmt::format("only {} greys were seen steadily; {} are needed", result.curve.size(), kLeastGreys),
            "Show more greys between 0 and 255, each until it is steady."};
        return result;
    }
    result.black_grey = both.black;
    result.white_grey = both.white;
    result.tiles = lit.tiles.size();
    result.saturated_tiles = lit.saturated;
    result.tiles_at_zero = lit.at_zero;
    result.white_drift = both.drift;
    fit_response(result);
    for (std::size_t i = 1; i < result.curve.size(); ++i) {
        const ResponsePoint &before = result.curve[i - 1], &now = result.curve[i];
        if (now.light < before.light - 3 * std::hypot(now.sigma, before.sigma) - 0.001)
            result.not_rising.push_back(now.grey);
    }
    constexpr std::array<Rgb, 3> kPure{{{255, 0, 0}, {0, 255, 0}, {0, 0, 255}}};
    if (std::all_of(kPure.begin(), kPure.end(), [&](const Rgb& c) { return both.colours.contains(c); })) {
        result.colours.emplace();
        for (std::size_t c = 0; c < 3; ++c) {
            (*result.colours)[c] = both.colours.at(kPure[c]).light;
            result.colour_sigmas[c] = both.colours.at(kPure[c]).sigma;
        }
    }
    result.black_level_is_a_bound = !both.covered;
    const double room = both.covered ? both.covered->first : 0;
    result.black_level = (both.black - room) / (both.white - room);
    result.black_level_sigma =
        std::hypot(both.black_sigma, both.covered ? both.covered->second : 0) / (both.white - room);
    std::vector<std::size_t> left, right;
    for (const std::size_t t : lit.tiles) (t < kTiles ? left : right).push_back(t);
    if (!left.empty() && !right.empty())
        result.cameras_differ =
            std::max(0.0, largest_difference(measured_on(recording, left).curve, measured_on(recording, right).curve));
    return result;
}

}  // namespace planlight
