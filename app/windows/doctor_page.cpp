#include "app/windows/doctor_page.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <optional>

#include "app/windows/doctor_page_panels.h"
#include "app/windows/gui_window.h"
#include "app/windows/operator_keys.h"
#include "app/windows/page_input.h"

namespace planlight {
namespace {

DoctorPageAction action_of(int key) {
    if (meaning_of(key) == KeyMeaning::dark) return DoctorPageAction::dark;
    if (meaning_of(key) == KeyMeaning::next) return DoctorPageAction::again;
    return key == GLFW_KEY_Q ? DoctorPageAction::quit : DoctorPageAction::none;
}

}  // namespace

struct DoctorPage::Parts {
    PageInput<DoctorPageAction> input;
    DoctorPageLayout place;
    DoctorPageScroll scroll;
    GuiWindow gui;
    std::optional<DoctorPageModel> drawn;

    explicit Parts(const WindowSettings& settings) : gui(settings, listener()) {}
    Parts(const Parts&) = delete;
    Parts& operator=(const Parts&) = delete;

    WindowListener listener() {
        return {[this](int key, int) {
                    input.press(action_of(key));
                    move_lines(key);
                },
                [this](double x, double y) {
                    if (place.dark.contains(x, y)) input.press(DoctorPageAction::dark);
                },
                [this](int key) { move_lines(key); }};
    }
    void move_lines(int key) {
        const int by = key == GLFW_KEY_DOWN ? 1 : key == GLFW_KEY_UP ? -1 : 0;
        scroll.wanted += by;
        scroll.good += by;
    }
    void move_lines_by_wheel() {
        const ImGuiIO& io = ImGui::GetIO();
        const int by = -static_cast<int>(io.MouseWheel);
        (place.wanted.contains(io.MousePos.x, io.MousePos.y) ? scroll.wanted : scroll.good) += by;
    }
    /// While it goes on, the line that was found last is seen; another examination begins at the top.
    void follow(const DoctorPageModel& model) {
        const std::size_t before = drawn ? drawn->lines.size() : 0;
        if (model.lines.size() < before) scroll = {};
        if (!model.over() && model.lines.size() > before) scroll.good = static_cast<int>(model.lines.size());
    }
};

DoctorPage::DoctorPage(WindowSettings settings) {
    settings.large_words = doctor_words();
    parts_ = std::make_unique<Parts>(settings);
}
DoctorPage::~DoctorPage() = default;

DoctorPageAction DoctorPage::frame(const DoctorPageModel& model) {
    Parts& parts = *parts_;
    parts.gui.take_input(0);
    if (parts.input.take_dark()) {
        parts.gui.forget_presses();
        return DoctorPageAction::dark;
    }
    if (parts.gui.asked_to_close()) return DoctorPageAction::quit;
    DoctorPageAction wanted = DoctorPageAction::none;
    const bool changed = !parts.drawn || !(*parts.drawn == model);
    if (changed) {
        parts.follow(model);
        parts.drawn = model;
    }
    if (changed || parts.gui.touched())
        parts.gui.frame([&](const Pen& pen, float w, float h) {
            parts.move_lines_by_wheel();
            parts.place = doctor_page_layout(w, h, pen.scale);
            wanted = draw_doctor_page(pen, parts.place, model, parts.scroll);
        });
    const DoctorPageAction pressed = parts.input.take();
    if (pressed == DoctorPageAction::again && !model.over()) return wanted;
    return pressed == DoctorPageAction::none ? wanted : pressed;
}

void DoctorPage::rest(double longest_s) {
    if (!parts_->gui.touched()) parts_->gui.take_input(longest_s);
}

RgbImage DoctorPage::screenshot() {
    return parts_->gui.screenshot();
}

}  // namespace planlight
