#include "registration/simulation/light.h"

#include <tbb/parallel_for.h>

#include <cmath>

#include "registration/simulation/blur.h"

namespace planlight::simulation {

namespace {
constexpr double kGamma = 2.2, kBlack = 1.0 / 700;
constexpr double kInFocus_px = 0.4, kOutOfFocus_px = 1.1;  ///< sigma of the lens's blur on the panel

std::array<float, 256> panel_response() {
    std::array<float, 256> response{};
    for (std::size_t v = 0; v < 256; ++v)
        response[v] = static_cast<float>(kBlack + (1 - kBlack) * std::pow(static_cast<double>(v) / 255, kGamma));
    return response;
}
}  // namespace

LightMap::LightMap(int width, int height, const RgbImage* picture) : width_(width + 2), height_(height + 2) {
    static const auto response = panel_response();
    const std::size_t count = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
    std::vector<float> sharp(count, 0);
    tbb::parallel_for(0, height, [&](int y) {
        float* row = sharp.data() + static_cast<std::size_t>(y + 1) * static_cast<std::size_t>(width_) + 1;
        for (int x = 0; x < width; ++x) {
            if (!picture) {
                row[x] = response[0];
                continue;
            }
            const Rgb& rgb = picture->at(x, y);  // as a monochrome sensor sees the three colours
            row[x] = 0.3F * response[rgb[0]] + 0.5F * response[rgb[1]] + 0.2F * response[rgb[2]];
        }
    });
    std::vector<float> soft = sharp, scratch;
    gaussian_blur(sharp, scratch, width_, height_, kInFocus_px);
    gaussian_blur(soft, scratch, width_, height_, kOutOfFocus_px);
    texels_.resize(count);
    for (std::size_t i = 0; i < count; ++i) texels_[i] = {sharp[i], soft[i]};
}

void LightSchedule::show(const RgbImage& picture, Instant now, Instant valid_until) {
    orders_.push_back({now + delay_, valid_until + delay_, std::make_shared<LightMap>(width_, height_, &picture)});
}

void LightSchedule::go_dark(Instant now) noexcept {
    try {
        orders_.push_back({now + delay_, now + delay_, nullptr});
    } catch (...) {
        orders_.clear();  // no memory left: dark at once
    }
}

std::shared_ptr<const LightMap> LightSchedule::at(Instant at) {
    while (orders_.size() > 1 && orders_[1].on <= at) orders_.pop_front();
    if (!orders_.empty()) {
        const Order& order = orders_.front();
        if (order.map && at >= order.on && at < order.off) return order.map;
    }
    if (!black_) black_ = std::make_shared<LightMap>(width_, height_, nullptr);
    return black_;
}

}  // namespace planlight::simulation
