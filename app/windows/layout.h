#pragma once

#include <array>

namespace planlight {

/// A rectangle in window pixels, from the top left.
struct Box {
    float x = 0, y = 0, width = 0, height = 0;
    float right() const { return x + width; }
    float bottom() const { return y + height; }
    bool contains(double at_x, double at_y) const {
        return at_x >= x && at_x < right() && at_y >= y && at_y < bottom();
    }
};

/// x, y, width, height of the box, rounded.
std::array<int, 4> whole_pixels(const Box& box);

/// Where everything stands in the operator window.
struct WindowLayout {
    float scale = 1;  ///< 1 at 1920 x 1080 and at 1080 x 1920
    float gap = 16;
    Box title, steps, dark, scene, left_camera, right_camera, table, buttons, banner;
};

/// The scale at 1280 x 720, and at 720 x 1280: below it all is shrunk.
inline constexpr float kLeastScale = 2.0F / 3;

/// No banner of a window that is wider than high is narrower than this, times the scale: one that is belongs to a
/// window on end.
inline constexpr float kLeastLyingBanner = 1860;

/// Of a button, and of the lowest part of any: 72 pixels at least (20 mm on a 24 inch screen), less only where the
/// whole window is smaller than 1280 x 720.
float button_height(float scale, float wanted = 76);

/// Right half of the upper edge of the 3-D view, so that the letters at the middle of its edges stay free: Before,
/// After, Error.
Box fit_row(const Box& scene, float scale);

/// The lowest button in the lower left corner of the 3-D view; the others stand above it.
Box corner_button(const Box& scene, float scale);

/// By how much all is smaller than at 1280 x 720, or 720 x 1280 on end: 1 from there on.
float shrinking(int width, int height);

/// For a window of that size, upright or on end. One smaller than 1280 x 720 looks as one of that size would, shrunk.
WindowLayout layout_of(int width, int height);

}  // namespace planlight
