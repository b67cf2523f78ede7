#include "app/windows/guide_window.h"

#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>
#include <utility>

#include "app/windows/camera_texture.h"
#include "app/windows/gui_window.h"
#include "app/windows/guide_panels.h"
#include "app/windows/panels.h"

namespace planlight {
namespace {

GuideAction action_of(int key) {
    if (key == GLFW_KEY_ENTER || key == GLFW_KEY_KP_ENTER) return GuideAction::keep;
    if (key == GLFW_KEY_DELETE) return GuideAction::discard;
    return key == GLFW_KEY_ESCAPE ? GuideAction::quit : GuideAction::none;
}

GuideAction draw_buttons(const Pen& pen, const Box& box, const GuideModel& model) {
    const float gap = 16 * pen.scale, width = (box.width - gap) / 2;
    const ButtonState free{!model.result.empty(), "when it is finished"};
    GuideAction wanted = GuideAction::none;
    if (button(pen, {box.x, box.y, width, box.height}, "Keep", free)) wanted = GuideAction::keep;
    if (button(pen, {box.x + width + gap, box.y, width, box.height}, "Discard", free)) wanted = GuideAction::discard;
    return wanted;
}

}  // namespace

struct GuideWindow::Parts {
    GuideAction pressed = GuideAction::none;
    GuiWindow gui;
    CameraTexture left{gui}, right{gui};

    explicit Parts(const WindowSettings& settings)
        : gui(settings, {[this](int key, int) {
                             if (const GuideAction action = action_of(key); action != GuideAction::none)
                                 pressed = action;
                         },
                         {}}) {}
    Parts(const Parts&) = delete;
    Parts& operator=(const Parts&) = delete;

    GuideAction draw(const Pen& pen, const GuideModel& model, float w, float h) {
        const float s = pen.scale, gap = 16 * s, title = 64 * s, banner = std::max(152.0F, 196 * s);
        pen.line(pen.fonts.title, pen.say(model.title), gap + 8 * s, gap + 14 * s, 0.6F * w, pen.theme->text);
        pen.line(pen.fonts.small, model.subtitle, gap + 8 * s, gap + 42 * s, 0.9F * w, pen.theme->quiet);
        const float top = gap + title, bottom = h - gap - banner - gap, column = std::max(420.0F, 0.28F * w);
        const float cameras = w - 3 * gap - column, camera_width = (cameras - gap) / 2;
        const float below = (model.result.empty() ? 240 : 430) * s;  // the result has more words
        const float camera_height = std::min(bottom - top - below, 0.8F * camera_width);
        const int pixels = static_cast<int>(camera_width);
        draw_guide_camera(pen, {gap, top, camera_width, camera_height}, model.left,
                          texture_id(left.take(model.left.picture, pixels)));
        draw_guide_camera(pen, {2 * gap + camera_width, top, camera_width, camera_height}, model.right,
                          texture_id(right.take(model.right.picture, pixels)));
        const float low = top + camera_height + gap, small = std::min((bottom - low) * 1.5F, 0.4F * cameras);
        draw_guide_cells(pen, {gap, low, small, bottom - low}, "In the projector's light", model.projector);
        draw_guide_progress(pen, {2 * gap + small, low, cameras - small - gap, bottom - low}, model);
        const float x = w - gap - column, depth = 110 * s, buttons = std::max(76.0F, 84 * s);
        draw_guide_tilts(pen, {x, top, column, bottom - top - depth - buttons - 2 * gap}, model);
        draw_guide_depths(pen, {x, bottom - depth - buttons - gap, column, depth}, model);
        const GuideAction wanted = draw_buttons(pen, {x, bottom - buttons, column, buttons}, model);
        draw_guide_banner(pen, {gap, h - gap - banner, w - 2 * gap, banner}, model);
        return wanted;
    }
};

GuideWindow::GuideWindow(WindowSettings settings) {
    settings.large_words = guide_words();
    parts_ = std::make_unique<Parts>(settings);
}
GuideWindow::~GuideWindow() = default;

GuideAction GuideWindow::frame(const GuideModel& model) {
    Parts& parts = *parts_;
    parts.gui.take_input(0);
    GuideAction wanted = GuideAction::none;
    parts.gui.frame([&](const Pen& pen, float w, float h) { wanted = parts.draw(pen, model, w, h); });
    const GuideAction pressed = std::exchange(parts.pressed, GuideAction::none);
    if (parts.gui.asked_to_close()) return GuideAction::quit;
    if (pressed == GuideAction::quit || !model.result.empty()) return pressed == GuideAction::none ? wanted : pressed;
    return wanted;
}

void GuideWindow::rest(double longest_s) {
    if (!parts_->gui.touched()) parts_->gui.take_input(longest_s);
}

RgbImage GuideWindow::screenshot() {
    return parts_->gui.screenshot();
}

}  // namespace planlight
