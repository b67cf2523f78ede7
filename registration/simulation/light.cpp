#include "registration/simulation/light.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "registration/simulation/blur.h"
#include "registration/simulation/hash.h"

namespace planlight::simulation {

namespace {
constexpr double kInFocus_px = 0.4, kOutOfFocus_px = 1.1;  ///< sigma of the lens's blur on the panel

std::array<float, 256> panel_response(const PanelSettings& panel) {
    std::array<float, 256> response{};
    for (std::size_t v = 0; v < 256; ++v) {
        double share = static_cast<double>(v) / 255;
        if (panel.dark_end > 0 || panel.bright_end < 1)
            share = std::clamp((share - panel.dark_end) / (panel.bright_end - panel.dark_end), 0.0, 1.0);
        response[v] = static_cast<float>(panel.black + (1 - panel.black) * std::pow(share, panel.gamma));
    }
    return response;
}

double evenly(std::uint64_t seed, std::uint64_t number) {
    return static_cast<double>(mixed(mixed(seed) ^ number) >> 11U) * 0x1.0p-53;
}
}  // namespace

LightMap::LightMap(int width, int height, const RgbImage* picture, const PanelSettings& panel,
                   const std::array<double, 3>& shares)
    : width_(width + 2), height_(height + 2) {
    const auto response = panel_response(panel);
    std::array<float, 3> colour{};
    for (std::size_t c = 0; c < 3; ++c) colour[c] = static_cast<float>(panel.colours[c] * shares[c]);
    const double all = panel.colours[0] * shares[0] + panel.colours[1] * shares[1] + panel.colours[2] * shares[2];
    const float black = std::abs(all - 1) < 1e-12 ? response[0] : static_cast<float>(all) * response[0];
    const std::size_t count = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
    std::vector<float> sharp(count, 0);
    tbb::parallel_for(0, height, [&](int y) {
        float* row = sharp.data() + static_cast<std::size_t>(y + 1) * static_cast<std::size_t>(width_) + 1;
        for (int x = 0; x < width; ++x) {
            if (!picture) {
                row[x] = black;
                continue;
            }
            const Rgb& rgb = picture->at(x, y);  // as a monochrome sensor sees the three colours
            row[x] = colour[0] * response[rgb[0]] + colour[1] * response[rgb[1]] + colour[2] * response[rgb[2]];
        }
    });
    std::vector<float> soft = sharp, scratch;
    gaussian_blur(sharp, scratch, width_, height_, kInFocus_px);
    gaussian_blur(soft, scratch, width_, height_, kOutOfFocus_px);
    texels_.resize(count);
    for (std::size_t i = 0; i < count; ++i) texels_[i] = {sharp[i], soft[i]};
}

LightMap LightMap::times(double factor) const {
    LightMap result = *this;
    const auto f = static_cast<float>(factor);
    for (auto& texel : result.texels_) texel = {f * texel[0], f * texel[1]};
    return result;
}

void LightMap::add(const LightMap& other) {
    for (std::size_t i = 0; i < texels_.size(); ++i) {
        texels_[i][0] += other.texels_[i][0];
        texels_[i][1] += other.texels_[i][1];
    }
}

/// When an order that is given now becomes light.
Instant LightSchedule::light_of(Instant now) {
    Instant on = now + delay_ + settings_.untold_delay;
    if (settings_.jitter > Instant{}) on += from_seconds(seconds(settings_.jitter) * evenly(seed_ + 1, truth_.size()));
    if (settings_.refresh_hz > 0)
        on = from_seconds(std::ceil(seconds(on) * settings_.refresh_hz - 1e-9) / settings_.refresh_hz);
    if (!orders_.empty()) on = std::max(on, orders_.back().on);
    return on;
}

void LightSchedule::push(Order order, Instant now) {
    order.on = light_of(now);
    const bool shown = !(settings_.skipped_orders > 0 && evenly(seed_ + 2, truth_.size()) < settings_.skipped_orders);
    truth_.push_back({now, order.on, shown});
    if (!order.picture) order.off = order.on;
    if (shown) orders_.push_back(std::move(order));
}

void LightSchedule::show(const RgbImage& picture, Instant now, Instant valid_until) {
    Order order;
    order.off = valid_until + delay_ + settings_.untold_delay;
    order.picture = std::make_shared<RgbImage>(picture);
    order.uniform =
        std::all_of(picture.pixels.begin(), picture.pixels.end(), [&](const Rgb& p) { return p == picture.pixels[0]; });
    push(std::move(order), now);
}

void LightSchedule::go_dark(Instant now) noexcept {
    try {
        push({}, now);
    } catch (...) {
        orders_.clear();  // no memory left: dark at once
    }
}

const LightSchedule::Order* LightSchedule::order_at(Instant at) const {
    const Order* newest = nullptr;
    for (const Order& order : orders_)
        if (order.on <= at) newest = &order;
    return newest && newest->picture && at < newest->off ? newest : nullptr;
}

std::shared_ptr<const LightMap> LightSchedule::during(Instant opened, Instant closed) {
    const Instant needed = settings_.over_exposure() ? opened : opened + (closed - opened) / 2;
    while (orders_.size() > 1 && orders_[1].on <= needed) orders_.pop_front();
    if (covered_) {
        if (!none_) none_ = std::make_shared<LightMap>(LightMap(width_, height_, nullptr).times(0));
        return none_;
    }
    if (frozen_) return frozen_;
    return settings_.over_exposure() ? sum_over(opened, closed) : at(needed);
}

void LightSchedule::freeze(Instant now) {
    frozen_ = at(now);
}

std::shared_ptr<const LightMap> LightSchedule::at(Instant at) {
    if (const Order* order = order_at(at)) {
        if (!order->map)
            order->map = std::make_shared<LightMap>(width_, height_, order->picture.get(), settings_.panel);
        return order->map;
    }
    if (!black_) black_ = std::make_shared<LightMap>(width_, height_, nullptr, settings_.panel);
    return black_;
}

/// Every picture by the time that it was there, every colour by the time that the wheel let it through.
std::shared_ptr<const LightMap> LightSchedule::sum_over(Instant opened, Instant closed) {
    std::vector<Instant> cuts{opened, closed};
    for (const Order& order : orders_)
        for (const Instant cut : {order.on, order.off})
            if (cut > opened && cut < closed) cuts.push_back(cut);
    std::sort(cuts.begin(), cuts.end());
    if (!full_) {
        const RgbImage white(width_, height_, {255, 255, 255});
        full_ = std::make_shared<LightMap>(width_, height_, &white);
    }
    const auto response = panel_response(settings_.panel);
    double even_light = 0;           // of pictures of one colour: a multiple of the full panel
    std::optional<LightMap> result;  // of the other pictures
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
        if (cuts[i + 1] == cuts[i]) continue;
        const double share = seconds(cuts[i + 1] - cuts[i]) / seconds(closed - opened);
        const auto wheel = wheel_during(settings_, cuts[i], cuts[i + 1]);
        const Order* found = order_at(cuts[i] + (cuts[i + 1] - cuts[i]) / 2);
        for (std::size_t c = 0; c < 3; ++c) {
            if (!found || found->uniform) {
                const std::uint8_t value = found ? found->picture->pixels[0][c] : std::uint8_t{0};
                even_light += share * wheel[c] * settings_.panel.colours[c] * static_cast<double>(response[value]);
                continue;
            }
            auto& map = found->colours[c];
            std::array<double, 3> only{};
            only[c] = 1;
            if (!map) map = std::make_shared<LightMap>(width_, height_, found->picture.get(), settings_.panel, only);
            if (result)
                result->add(map->times(share * wheel[c]));
            else
                result = map->times(share * wheel[c]);
        }
    }
    LightMap even = full_->times(even_light);
    if (result) even.add(*result);
    return std::make_shared<LightMap>(std::move(even));
}

}  // namespace planlight::simulation
