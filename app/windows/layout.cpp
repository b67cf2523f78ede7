#include "app/windows/layout.h"

#include <algorithm>
#include <cmath>

namespace planlight {

float button_height(float scale, float wanted) {
    constexpr float kLeast = 72;
    return std::max(kLeast * std::min(1.0F, scale / kLeastScale), wanted * scale);
}

float shrinking(int width, int height) {
    const auto [shorter, longer] = std::minmax(width, height);
    return std::min({1.0F, static_cast<float>(longer) / 1280, static_cast<float>(shorter) / 720});
}

Box fit_row(const Box& scene, float scale) {
    const float from = scene.x + 0.5F * scene.width + 44 * scale;
    return {from, scene.y + 12 * scale, scene.right() - 12 * scale - from, button_height(scale)};
}

Box corner_button(const Box& scene, float scale) {
    const float height = button_height(scale);
    return {scene.x + 12 * scale, scene.bottom() - 12 * scale - height,
            std::max(0.7F * fit_row(scene, scale).width, 372 * scale), height};
}

namespace {

/// Beside the 3-D view stand pictures, table and buttons.
WindowLayout lying(float w, float h) {
    WindowLayout place;
    const float s = place.scale = std::clamp(std::min(w / 1920, h / 1080), 0.6F, 3.0F);
    const float gap = place.gap = std::round(16 * s);
    const float button = std::max(76.0F, std::round(84 * s));
    const float banner = std::max(152.0F, std::round(196 * s));
    const float top = button + 2 * std::round(10 * s);

    place.dark = {w - gap - 250 * s, std::round(10 * s), 250 * s, button};
    place.title = {gap + 8 * s, std::round(10 * s), std::round(0.34F * w), button};
    place.steps = {place.title.right() + gap, std::round(10 * s), place.dark.x - place.title.right() - 2 * gap, button};
    place.banner = {gap, h - gap - banner, w - 2 * gap, banner};

    const float main_height = place.banner.y - gap - top;
    const float column = std::round(std::clamp(0.362F * w, 460.0F, 900.0F * s));
    const float column_x = w - gap - column;
    place.scene = {gap, top, column_x - 2 * gap, main_height};
    const float camera_width = std::floor((column - gap) / 2), camera_height = std::round(0.64F * camera_width);
    place.left_camera = {column_x, top, camera_width, camera_height};
    place.right_camera = {column_x + column - camera_width, top, camera_width, camera_height};
    place.buttons = {column_x, place.banner.y - gap - button, column, button};
    const float table_y = place.left_camera.bottom() + gap;
    place.table = {column_x, table_y, column, place.buttons.y - gap - table_y};
    return place;
}

/// Below the 3-D view stand pictures and table side by side, then the buttons.
WindowLayout on_end(float w, float h) {
    WindowLayout place;
    const float s = place.scale = std::clamp(std::min(w / 1080, h / 1920), 0.6F, 3.0F);
    const float gap = place.gap = std::round(16 * s), edge = std::round(10 * s);
    const float button = std::max(76.0F, std::round(84 * s)), banner = std::round(360 * s);

    place.dark = {w - gap - 250 * s, edge, 250 * s, button};
    place.title = {gap + 8 * s, edge, place.dark.x - 2 * gap - 8 * s, button};
    place.steps = {gap, place.title.bottom() + edge, w - 2 * gap, button};
    place.banner = {gap, h - gap - banner, w - 2 * gap, banner};
    place.buttons = {gap, place.banner.y - gap - button, w - 2 * gap, button};

    const float camera_width = std::round(std::min(0.33F * w, 0.186F * h)),
                camera_height = std::round(0.64F * camera_width);
    const float second_y = place.buttons.y - gap - camera_height, first_y = second_y - gap - camera_height;
    place.left_camera = {gap, first_y, camera_width, camera_height};
    place.right_camera = {gap, second_y, camera_width, camera_height};
    const float table_x = place.left_camera.right() + gap;
    place.table = {table_x, first_y, w - gap - table_x, place.buttons.y - gap - first_y};
    const float top = place.steps.bottom() + edge;
    place.scene = {gap, top, w - 2 * gap, first_y - gap - top};
    return place;
}

}  // namespace

WindowLayout layout_of(int width, int height) {
    const float shrunk = shrinking(width, height);
    const float w = static_cast<float>(width) / shrunk, h = static_cast<float>(height) / shrunk;
    WindowLayout place = height > width ? on_end(w, h) : lying(w, h);
    place.scale *= shrunk;
    place.gap *= shrunk;
    for (Box* box : {&place.title, &place.steps, &place.dark, &place.scene, &place.left_camera, &place.right_camera,
                     &place.table, &place.buttons, &place.banner})
        *box = {box->x * shrunk, box->y * shrunk, box->width * shrunk, box->height * shrunk};
    return place;
}

std::array<int, 4> whole_pixels(const Box& box) {
    return {static_cast<int>(box.x), static_cast<int>(box.y), static_cast<int>(box.width),
            static_cast<int>(box.height)};
}

}  // namespace planlight
