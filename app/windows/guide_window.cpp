#include "app/windows/guide_window.h"

#include <GLFW/glfw3.h>
#include <imgui.h>

#include <utility>

#include "app/windows/camera_texture.h"
#include "app/windows/gui_window.h"
#include "app/windows/guide_panels.h"

namespace planlight {
namespace {

GuideAction action_of(int key) {
    if (key == GLFW_KEY_ENTER || key == GLFW_KEY_KP_ENTER) return GuideAction::keep;
    if (key == GLFW_KEY_DELETE) return GuideAction::discard;
    return key == GLFW_KEY_ESCAPE ? GuideAction::quit : GuideAction::none;
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
        const GuideLayout place = guide_layout(static_cast<int>(w), static_cast<int>(h), !model.result.empty());
        const int pixels = static_cast<int>(place.left.width);
        return draw_guide(
            pen, place, model,
            {texture_id(left.take(model.left.picture, pixels)), texture_id(right.take(model.right.picture, pixels))});
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
