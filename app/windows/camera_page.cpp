#include "app/windows/camera_page.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>
#include <optional>

#include "app/windows/camera_page_panels.h"
#include "app/windows/camera_texture.h"
#include "app/windows/exposure_overlay.h"
#include "app/windows/gui_window.h"
#include "app/windows/operator_keys.h"
#include "app/windows/page_input.h"

namespace planlight {
namespace {

CameraPageAction action_of(int key) {
    if (meaning_of(key) == KeyMeaning::dark) return CameraPageAction::dark;
    switch (key) {
        case GLFW_KEY_F:
            return CameraPageAction::frame;
        case GLFW_KEY_S:
            return CameraPageAction::star;
        case GLFW_KEY_G:
            return CameraPageAction::steps;
        case GLFW_KEY_N:
            return CameraPageAction::name;
        case GLFW_KEY_R:
            return CameraPageAction::forget_best;
        case GLFW_KEY_Q:
            return CameraPageAction::quit;
        default:
            return CameraPageAction::none;
    }
}

/// A camera's picture with its exposure over it, made anew only for another picture or another size.
class OverlaidPicture {
public:
    explicit OverlaidPicture(GuiWindow& window) : texture_(window) {}
    unsigned take(const std::shared_ptr<const GrayImage>& picture, float pixels) {
        if (!picture || picture->empty()) return 0;
        const int by = std::max(1, picture->width / std::max(1, static_cast<int>(pixels)));
        if (picture != of_ || by != by_) overlaid_ = std::make_shared<const RgbImage>(exposure_overlay(*picture, by));
        of_ = picture;
        by_ = by;
        return texture_.take(overlaid_);
    }

private:
    ColourTexture texture_;
    std::shared_ptr<const GrayImage> of_;
    int by_ = 0;
    std::shared_ptr<const RgbImage> overlaid_;
};

}  // namespace

struct CameraPage::Parts {
    PageInput<CameraPageAction> input;
    CameraPageLayout place;
    GuiWindow gui;
    OverlaidPicture left{gui}, right{gui};
    std::optional<CameraPageModel> drawn;

    explicit Parts(const WindowSettings& settings) : gui(settings, listener()) {}
    Parts(const Parts&) = delete;
    Parts& operator=(const Parts&) = delete;

    WindowListener listener() {
        return {[this](int key, int) { input.press(action_of(key)); },
                [this](double x, double y) {
                    if (place.dark.contains(x, y)) input.press(CameraPageAction::dark);
                }};
    }
};

CameraPage::CameraPage(const WindowSettings& settings) : parts_(std::make_unique<Parts>(settings)) {}
CameraPage::~CameraPage() = default;

CameraPageAction CameraPage::frame(const CameraPageModel& model) {
    Parts& parts = *parts_;
    parts.gui.take_input(0);
    if (parts.input.take_dark()) {
        parts.gui.forget_presses();
        return CameraPageAction::dark;
    }
    if (parts.gui.asked_to_close()) return CameraPageAction::quit;
    CameraPageAction wanted = CameraPageAction::none;
    const bool changed = !parts.drawn || !(*parts.drawn == model) || parts.gui.touched();
    if (changed) parts.drawn = model;
    if (changed)
        parts.gui.frame([&](const Pen& pen, float w, float h) {
            parts.place = camera_page_layout(w, h, pen.scale);
            wanted =
                draw_camera_page(pen, parts.place, model,
                                 {texture_id(parts.left.take(model.left.picture, parts.place.picture[0].width)),
                                  texture_id(parts.right.take(model.right.picture, parts.place.picture[1].width))});
        });
    const CameraPageAction pressed = parts.input.take();
    if (wanted_picture(pressed) && !model.no_light.empty()) return wanted;
    return pressed == CameraPageAction::none ? wanted : pressed;
}

void CameraPage::rest(double longest_s) {
    if (!parts_->gui.touched()) parts_->gui.take_input(longest_s);
}

RgbImage CameraPage::screenshot() {
    return parts_->gui.screenshot();
}

}  // namespace planlight
