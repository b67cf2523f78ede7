#pragma once

#include <array>
#include <deque>
#include <memory>
#include <vector>

#include "planning_io/types/image.h"
#include "planning_io/types/time.h"

namespace planlight::simulation {

/// What leaves the projector, per panel pixel, linear, 1 = white: as sharp as the lens can and as blurred as it gets away
/// from the focus. Outside the panel there is no light; a black pixel still leaks.
class LightMap {
public:
    /// `picture` may be null: a black panel of this size.
    LightMap(int width, int height, const RgbImage* picture);

    /// Light at a panel position (pixel centres at integers); `blur` 0 = in focus, 1 = far out of it.
    float at(float u, float v, float blur) const {
        const float x = u + 1, y = v + 1;  // one dark pixel of padding
        if (!(x >= 0 && y >= 0 && x < static_cast<float>(width_ - 1) && y < static_cast<float>(height_ - 1))) return 0;
        const int i = static_cast<int>(x), j = static_cast<int>(y);
        const float a = x - static_cast<float>(i), b = y - static_cast<float>(j);
        const auto* p = texels_.data() + static_cast<std::size_t>(j) * static_cast<std::size_t>(width_) +
                        static_cast<std::size_t>(i);
        const auto* q = p + width_;
        const auto value = [&](std::size_t c) {
            const float top = p[0][c] + a * (p[1][c] - p[0][c]), low = q[0][c] + a * (q[1][c] - q[0][c]);
            return top + b * (low - top);
        };
        const float sharp = value(0);
        return sharp + blur * (value(1) - sharp);
    }

private:
    int width_ = 0, height_ = 0;  ///< with padding
    std::vector<std::array<float, 2>> texels_;
};

/// What the projector was told to show, and when that is light on the patient.
class LightSchedule {
public:
    LightSchedule(int width, int height, Instant delay) : width_(width), height_(height), delay_(delay) {}

    /// Light from now + delay to valid_until + delay, or until the next order is light.
    void show(const RgbImage& picture, Instant now, Instant valid_until);
    void go_dark(Instant now) noexcept;

    /// The panel at a moment; never null. Orders that ended before `at` are forgotten.
    std::shared_ptr<const LightMap> at(Instant at);

private:
    struct Order {
        Instant on{}, off{};
        std::shared_ptr<const LightMap> map;  ///< null: dark
    };
    int width_, height_;
    Instant delay_;
    std::deque<Order> orders_;
    std::shared_ptr<const LightMap> black_;
};

}  // namespace planlight::simulation
