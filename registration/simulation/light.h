#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "planning_io/types/image.h"
#include "planning_io/types/time.h"
#include "registration/simulation/light_settings.h"

namespace planlight::simulation {

/// What leaves the projector, per panel pixel, linear, 1 = white: as sharp as the lens can and as blurred as it gets
/// away from the focus. Outside the panel there is no light; a black pixel still leaks.
class LightMap {
public:
    /// `picture` may be null: a black panel of this size. `shares`: how much of the light of each colour is there (a
    /// colour wheel shows one after the other).
    LightMap(int width, int height, const RgbImage* picture, const PanelSettings& panel = {},
             const std::array<double, 3>& shares = {1, 1, 1});

    /// The same panel `factor` times as bright.
    LightMap times(double factor) const;
    void add(const LightMap& other);

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

/// When an order was given and when it became light: the truth about a projector's delay.
struct TrueLight {
    Instant asked{}, lit{};
    bool shown = true;  ///< false: the projector left this picture out
};

/// What the projector was told to show, and when that is light on the patient.
class LightSchedule {
public:
    LightSchedule(int width, int height, Instant delay, const LightSettings& settings = {}, std::uint64_t seed = 0)
        : width_(width), height_(height), delay_(delay), settings_(settings), seed_(seed) {}

    /// Light from now + delay to valid_until + delay, or until the next order is light.
    void show(const RgbImage& picture, Instant now, Instant valid_until);
    void go_dark(Instant now) noexcept;
    void set_untold_delay(Instant delay) { settings_.untold_delay = delay; }
    /// From now on, whatever is ordered, the light is that of this moment: a panel that was frozen.
    void freeze(Instant now);
    void cover(bool lens_is_covered) { covered_ = lens_is_covered; }  ///< no light at all, also no leak

    /// The light that an exposure gets: that of its middle, or of all of it where the settings say so; never null.
    /// Orders that ended before `opened` are forgotten.
    std::shared_ptr<const LightMap> during(Instant opened, Instant closed);

    /// Every order so far, going dark included.
    const std::vector<TrueLight>& truth() const { return truth_; }

private:
    struct Order {
        Instant on{}, off{};
        std::shared_ptr<const RgbImage> picture;  ///< null: dark
        bool uniform = false;                     ///< one colour all over
        // Made when a camera asks for them: a projector costs the program no time.
        mutable std::shared_ptr<const LightMap> map;                     ///< of all colours at once
        mutable std::array<std::shared_ptr<const LightMap>, 3> colours;  ///< one a colour
    };
    void push(Order order, Instant now);
    Instant light_of(Instant now);
    std::shared_ptr<const LightMap> at(Instant at);
    std::shared_ptr<const LightMap> sum_over(Instant opened, Instant closed);
    const Order* order_at(Instant at) const;

    int width_, height_;
    Instant delay_;
    LightSettings settings_;
    std::uint64_t seed_;
    bool covered_ = false;
    std::deque<Order> orders_;
    std::vector<TrueLight> truth_;
    std::shared_ptr<const LightMap> black_, full_, none_, frozen_;
};

}  // namespace planlight::simulation
