#include "app/windows/guide_layout.h"

#include <algorithm>
#include <cmath>

namespace planlight {
namespace {

/// What both have in common, for a window that is not shrunk.
struct Measures {
    float gap, top, banner, button, bottom;
    Measures(float s, float h, float banner_height)
        : gap(16 * s),
          top(gap + 64 * s),
          banner(banner_height),
          button(button_height(s, 84)),
          bottom(h - 2 * gap - banner) {}
};

/// Beside the cameras' pictures stand tilts, distances and buttons; below them cells and words.
GuideLayout lying(float s, float w, float h, bool with_result) {
    const Measures m(s, h, std::max(152.0F, 196 * s));
    const float gap = m.gap, column = std::max(420.0F, 0.28F * w), column_x = w - gap - column;
    const float cameras = column_x - 2 * gap, camera_width = (cameras - gap) / 2;
    const float camera_height = std::min(m.bottom - m.top - (with_result ? 430 : 240) * s, 0.8F * camera_width);
    const float low = m.top + camera_height + gap, below = m.bottom - low,
                small = std::min(below * 1.5F, 0.4F * cameras), depths = 110 * s;
    GuideLayout place;
    place.left = {gap, m.top, camera_width, camera_height};
    place.right = {2 * gap + camera_width, m.top, camera_width, camera_height};
    place.projector = {gap, low, small, below};
    place.progress = {2 * gap + small, low, cameras - small - gap, below};
    place.tilts = {column_x, m.top, column, m.bottom - m.top - depths - m.button - 2 * gap};
    place.depths = {column_x, m.bottom - depths - m.button - gap, column, depths};
    place.buttons = {column_x, m.bottom - m.button, column, m.button};
    place.banner = {gap, h - gap - m.banner, w - 2 * gap, m.banner};
    return place;
}

/// One below the other: cameras, tilts and words, cells and distances, buttons.
GuideLayout on_end(float s, float w, float h) {
    const Measures m(s, h, 360 * s);
    const float gap = m.gap, half = (w - 3 * gap) / 2, other_half = 2 * gap + half;
    const float camera_height = std::min(0.3F * (m.bottom - m.top), 0.8F * half), cells = 200 * s;
    const float middle = m.top + camera_height + gap, buttons = m.bottom - m.button, low = buttons - gap - cells;
    GuideLayout place;
    place.left = {gap, m.top, half, camera_height};
    place.right = {other_half, m.top, half, camera_height};
    place.tilts = {gap, middle, half, low - gap - middle};
    place.progress = {other_half, middle, half, low - gap - middle};
    place.projector = {gap, low, half, cells};
    place.depths = {other_half, low, half, cells};
    place.buttons = {gap, buttons, w - 2 * gap, m.button};
    place.banner = {gap, h - gap - m.banner, w - 2 * gap, m.banner};
    return place;
}

}  // namespace

GuideLayout guide_layout(int width, int height, bool with_result) {
    const float shrunk = shrinking(width, height), scale = layout_of(width, height).scale;
    const float w = static_cast<float>(width) / shrunk, h = static_cast<float>(height) / shrunk, s = scale / shrunk;
    GuideLayout place = height > width ? on_end(s, w, h) : lying(s, w, h, with_result);
    place.scale = scale;
    for (Box* box : {&place.left, &place.right, &place.projector, &place.progress, &place.tilts, &place.depths,
                     &place.buttons, &place.banner})
        *box = {box->x * shrunk, box->y * shrunk, box->width * shrunk, box->height * shrunk};
    return place;
}

}  // namespace planlight
