#include "projection/stroke_raster.h"

#include <algorithm>
#include <cmath>

namespace planlight {
namespace {

/// What a number is multiplied by for a share of its light, of many shares: a power costs too much for every pixel.
float number_share(float light_share) {
    constexpr int kSteps = 4096;
    static const std::vector<float> kTable = [] {
        std::vector<float> table;
        for (int i = 0; i <= kSteps; ++i)
            table.push_back(static_cast<float>(std::pow(static_cast<double>(i) / kSteps, 1 / kPanelGamma)));
        return table;
    }();
    return kTable[static_cast<std::size_t>(std::lround(std::clamp(light_share, 0.0f, 1.0f) * kSteps))];
}

}  // namespace

std::uint8_t number_for_light(std::uint8_t full, double share) {
    return static_cast<std::uint8_t>(std::lround(full * std::pow(std::clamp(share, 0.0, 1.0), 1 / kPanelGamma)));
}

StrokeRaster::StrokeRaster(int width, int height)
    : width_(width),
      height_(height),
      coverage_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0.0f) {}

/// One edge's signed area per pixel, so that sums along rows give coverage (Levien 2016, font-rs). Corner-origin
/// pixels.
void StrokeRaster::add_edge(Eigen::Vector2d from, Eigen::Vector2d to) {
    if (from.y() == to.y()) return;
    const double sign = from.y() < to.y() ? 1 : -1;
    if (sign < 0) std::swap(from, to);
    const double slope = (to.x() - from.x()) / (to.y() - from.y());
    double x = from.x();
    const int last = std::min(area_height_, static_cast<int>(std::ceil(to.y())));
    for (int y = static_cast<int>(from.y()); y < last; ++y) {
        float* row = area_.data() + static_cast<std::ptrdiff_t>(y) * area_width_;
        const double dy = std::min(y + 1.0, to.y()) - std::max(static_cast<double>(y), from.y());
        const double next = x + slope * dy, d = dy * sign;
        const double x0 = std::min(x, next), x1 = std::max(x, next);
        const int first = static_cast<int>(x0), end = static_cast<int>(std::ceil(x1));
        if (end <= first + 1) {
            const double middle = 0.5 * (x + next) - first;
            row[first] += static_cast<float>(d - d * middle);
            row[first + 1] += static_cast<float>(d * middle);
        } else {
            const double s = 1 / (x1 - x0), in_first = 1 - (x0 - first), in_last = x1 - end + 1;
            const double a0 = 0.5 * s * in_first * in_first, am = 0.5 * s * in_last * in_last;
            row[first] += static_cast<float>(d * a0);
            if (end == first + 2) {
                row[first + 1] += static_cast<float>(d * (1 - a0 - am));
            } else {
                const double a1 = s * (0.5 + in_first);
                row[first + 1] += static_cast<float>(d * (a1 - a0));
                for (int column = first + 2; column < end - 1; ++column) row[column] += static_cast<float>(d * s);
                const double a2 = a1 + (end - first - 3) * s;
                row[end - 1] += static_cast<float>(d * (1 - a2 - am));
            }
            row[end] += static_cast<float>(d * am);
        }
        x = next;
    }
}

void StrokeRaster::add(std::span<const Eigen::Vector2d> outline, std::span<const std::vector<Eigen::Vector2d>> more) {
    const auto each_outline = [&](const auto& visit) {
        if (!outline.empty()) visit(outline);
        for (const auto& other : more) visit(std::span<const Eigen::Vector2d>(other));
    };
    Eigen::Vector2d low(1e300, 1e300), high = -low;
    bool finite = true;
    each_outline([&](std::span<const Eigen::Vector2d> corners) {
        for (const auto& c : corners) {
            finite = finite && c.allFinite();
            low = low.cwiseMin(c);
            high = high.cwiseMax(c);
        }
    });
    if (!finite || !(low.x() <= high.x())) return;
    const Eigen::Vector2d half(0.5, 0.5);  // to corner-origin pixels
    low += half;
    high += half;
    constexpr double kMargin_px = 4096;  // no stroke segment is this large; keeps the working area bounded
    if (high.x() < 0 || high.y() < 0 || low.x() > width_ || low.y() > height_) return;
    if ((high - low).maxCoeff() > kMargin_px) return;
    const int left = static_cast<int>(std::floor(low.x())), top = static_cast<int>(std::floor(low.y()));
    area_width_ = static_cast<int>(std::ceil(high.x())) - left + 2;
    area_height_ = static_cast<int>(std::ceil(high.y())) - top;
    if (area_height_ <= 0) return;
    area_.assign(static_cast<std::size_t>(area_width_) * static_cast<std::size_t>(area_height_), 0.0f);
    const Eigen::Vector2d origin(left, top);
    each_outline([&](std::span<const Eigen::Vector2d> corners) {
        for (std::size_t i = 0; i < corners.size(); ++i)
            add_edge(corners[i] + half - origin, corners[(i + 1) % corners.size()] + half - origin);
    });
    for (int y = std::max(0, -top); y < std::min(area_height_, height_ - top); ++y) {
        const float* row = area_.data() + static_cast<std::ptrdiff_t>(y) * area_width_;
        float sum = 0;
        for (int x = 0; x < area_width_; ++x) {
            sum += row[x];
            const int column = left + x;
            if (std::abs(sum) < 1e-4f || column < 0 || column >= width_) continue;
            const auto i =
                static_cast<std::size_t>(top + y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(column);
            if (coverage_[i] == 0) touched_.push_back(i);
            coverage_[i] += std::min(1.0f, std::abs(sum));
        }
    }
}

std::size_t StrokeRaster::flush(Rgb colour, RgbImage& picture) {
    const std::size_t count = touched_.size();
    for (const std::size_t i : touched_) {
        const float share = number_share(coverage_[i]);
        for (std::size_t c = 0; c < 3; ++c) {
            const auto value = static_cast<std::uint8_t>(std::lround(share * static_cast<float>(colour[c])));
            picture.pixels[i][c] = std::max(picture.pixels[i][c], value);
        }
        coverage_[i] = 0;
    }
    touched_.clear();
    return count;
}

}  // namespace planlight
