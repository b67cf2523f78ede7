#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/windows/camera_page_panels.h"
#include "app/windows/exposure_overlay.h"

namespace planlight {
namespace {

/// The sharpness as a number and as a bar; the mark is the best that was seen, and stands at 85 % of the bar.
void draw_sharpness(const Pen& pen, const Box& box, const CameraPageModel::Camera& camera) {
    constexpr double kBestStandsAt = 0.85, kNearTheBest = 0.97;
    const float s = pen.scale, middle = box.y + box.height / 2, words = 0.3F * box.width, figures = 0.16F * box.width;
    pen.line(pen.fonts.body, pen.say("Sharpness"), box.x, middle, words - 8 * s, pen.theme->text);
    pen.line(pen.fonts.number, fmt::format("{:.2f}", camera.sharpness), box.x + words, middle, figures,
             pen.theme->text);
    const float x = box.x + words + figures + 10 * s, width = box.right() - x, high = 0.42F * box.height;
    const auto share = [&](double value) {
        return camera.best_sharpness > 0
                   ? static_cast<float>(std::min(1.0, kBestStandsAt * value / camera.best_sharpness))
                   : 0.0F;
    };
    const ImVec2 low(x, middle - high / 2), high_end(x + width, middle + high / 2);
    pen.list->AddRectFilled(low, high_end, pen.theme->background, 4 * s);
    const bool best = camera.sharpness >= kNearTheBest * camera.best_sharpness;
    pen.list->AddRectFilled(low, {x + width * share(camera.sharpness), high_end.y},
                            best ? pen.theme->green : pen.theme->blue, 4 * s);
    pen.list->AddRect(low, high_end, pen.theme->edge, 4 * s);
    if (camera.best_sharpness <= 0) return;
    const float mark = x + width * share(camera.best_sharpness);
    pen.list->AddRectFilled({mark - 2 * s, low.y - 6 * s}, {mark + 2 * s, high_end.y + 6 * s}, pen.theme->text);
}

/// A figure under its name; a square of the colour that it has in the picture where it has one.
void draw_figure(const Pen& pen, const Box& box, const std::string& name, const std::string& value, ImU32 colour,
                 const Rgb* swatch = nullptr) {
    const float high = line_height(pen.fonts.small), side = 0.7F * high;
    const float indent = swatch ? side + 6 * pen.scale : 0;
    if (swatch) pen.swatch({box.x, box.y + (high - side) / 2, side, side}, *swatch);
    pen.line(pen.fonts.small, pen.say(name), box.x + indent, box.y + high / 2, box.width - indent, pen.theme->quiet);
    pen.line(pen.fonts.body, value, box.x, box.y + high + line_height(pen.fonts.body) / 2, box.width, colour);
}

void draw_grid(const Pen& pen, const Box& box, const CameraPageModel::Camera& camera) {
    constexpr double kSomeBright_percent = 1, kRateOff = 0.05;
    const float row = line_height(pen.fonts.small) + line_height(pen.fonts.body) + 4 * pen.scale,
                column = box.width / 3, width = column - 12 * pen.scale;
    const auto cell = [&](int x, int y) {
        return Box{box.x + column * static_cast<float>(x), box.y + row * static_cast<float>(y), width, row};
    };
    const ImU32 plain = pen.theme->text;
    const bool slow = camera.asked_hz && std::abs(camera.frames_hz - *camera.asked_hz) > kRateOff * *camera.asked_hz;
    draw_figure(pen, cell(0, 0), "Too bright", fmt::format("{:.1f} %", camera.too_bright_percent),
                camera.too_bright_percent > kSomeBright_percent ? pen.theme->amber : plain, &kTooBright_colour);
    draw_figure(pen, cell(1, 0), "Too dark", fmt::format("{:.1f} %", camera.too_dark_percent), plain, &kTooDark_colour);
    draw_figure(pen, cell(2, 0), "Exposure", fmt::format("{:.2f} ms", camera.exposure_ms), plain);
    draw_figure(
        pen, cell(0, 1), "Frames a second",
        fmt::format("{:.1f}{}", camera.frames_hz, camera.asked_hz ? fmt::format(" / {:g}", *camera.asked_hz) : ""),
        slow ? pen.theme->amber : plain);
    draw_figure(pen, cell(1, 1), "Lost frames", std::to_string(camera.lost),
                camera.lost > 0 ? pen.theme->amber : plain);
    draw_figure(pen, cell(2, 1), "Markers", std::to_string(camera.markers.size()), plain);
}

}  // namespace

void draw_camera_figures(const Pen& pen, const Box& box, const CameraPageModel::Camera& camera) {
    pen.panel(box);
    const float s = pen.scale, pad = 16 * s, x = box.x + pad, width = box.width - 2 * pad;
    const float sharpness = line_height(pen.fonts.number) + 8 * s;
    draw_sharpness(pen, {x, box.y + 6 * s, width, sharpness}, camera);
    const float grid = box.y + 6 * s + sharpness + 2 * s;
    draw_grid(pen, {x, grid, width, box.bottom() - grid}, camera);
    const float rows = 2 * (line_height(pen.fonts.small) + line_height(pen.fonts.body) + 4 * s);
    const Box below{x, grid + rows, width, box.bottom() - grid - rows - 4 * s};
    if (!camera.trouble.empty()) {
        pen.paragraph(pen.fonts.small, pen.say(camera.trouble) + ". " + pen.say(camera.trouble_remedy), below,
                      pen.theme->red);
        return;
    }
    std::string notes;
    for (const std::string& note : camera.notes) notes += pen.say(note) + ". ";
    if (!notes.empty()) pen.paragraph(pen.fonts.small, notes, below, pen.theme->amber);
}

}  // namespace planlight
