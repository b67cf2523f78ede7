#pragma once

#include <array>

namespace planlight {

/// A rectangle in window pixels, from the top left.
struct Box {
    float x = 0, y = 0, width = 0, height = 0;
    float right() const { return x + width; }
    float bottom() const { return y + height; }
};

/// x, y, width, height of the box, rounded.
std::array<int, 4> whole_pixels(const Box& box);

/// Where everything stands in the operator window.
struct WindowLayout {
    float scale = 1;  ///< 1 at 1920 x 1080 and at 1080 x 1920
    float gap = 16;
    Box title, steps, dark, scene, left_camera, right_camera, table, buttons, banner;
};

/// Right half of the upper edge of the 3-D view, so that the letters at the middle of its edges stay free: Before,
/// After, Error.
Box fit_row(const Box& scene, float scale);

/// The lowest button in the lower left corner of the 3-D view; the others stand above it.
Box corner_button(const Box& scene, float scale);

/// For a window of that size, at least 1280 x 720, or 720 x 1280 on end. Buttons are never lower than 72 pixels (20 mm
/// on a 24 inch screen).
WindowLayout layout_of(int width, int height);

}  // namespace planlight
