#include "app/windows/operator_window.h"
#include "app/windows/changed_meaning.h"

#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <thread>
#include <utility>

#include "app/windows/camera_texture.h"
#include "app/windows/gui_window.h"
#include "app/windows/layout.h"
#include "app/windows/middle_view.h"
#include "app/windows/operator_keys.h"
#include "app/windows/page_input.h"
#include "app/windows/panels.h"

namespace planlight {
namespace {

using std::chrono::steady_clock;

constexpr auto kNoticeStands = std::chrono::seconds(4);

/// The four buttons of a session's way.
struct WayButton {
    OperatorAction action;
    const char* label;
    KeyMeaning key;
    ButtonState OperatorModel::*state;
};
constexpr WayButton kWay[] = {
    {OperatorAction::scan, "Scan", KeyMeaning::scan, &OperatorModel::scan},
    {OperatorAction::do_register, "Register", KeyMeaning::do_register, &OperatorModel::do_register},
    {OperatorAction::track, "Track", KeyMeaning::track, &OperatorModel::track},
    {OperatorAction::stop, "Stop", KeyMeaning::stop, &OperatorModel::stop},
};

}  // namespace

struct OperatorWindow::Parts {
    PageInput<KeyMeaning> input;
    ChangedMeaning changed_meaning;
    WindowLayout place;
    GuiWindow gui;
    std::unique_ptr<MiddleView> middle;
    CameraTexture left{gui}, right{gui};
    float rows_scrolled = 0;
    std::optional<std::size_t> marked_row;  ///< in the last frame
    std::map<OperatorAction, Box> controls;
    std::map<std::string, Box> places;
    bool live_instead_of_refused = false;
    bool asks_to_close = false;
    std::string notice;  ///< why the last press did nothing
    steady_clock::time_point notice_until{};
    std::optional<OperatorModel> drawn;
    std::size_t frames = 0;

    explicit Parts(const WindowSettings& settings) : gui(settings, listener()) {
        middle = std::make_unique<MiddleView>(gui.font_files(), [this] { gui.make_current(); });
    }
    Parts(const Parts&) = delete;
    Parts& operator=(const Parts&) = delete;

    WindowListener listener() {
        return {[this](int pressed, int) { input.press(meaning_of(pressed)); },
                [this](double x, double y) {
                    if (place.dark.contains(x, y)) input.press(KeyMeaning::dark);
                }};
    }

    void say(const std::string& words) {
        notice = words;
        notice_until = steady_clock::now() + kNoticeStands;
    }

    bool must_draw(const OperatorModel& model) const {
        return gui.touched() || input.waits() || middle->wants_frame() || !drawn || !(*drawn == model) ||
               (!notice.empty() && steady_clock::now() > notice_until);
    }

    /// The action where its button is enabled; else the reason is said.
    OperatorAction if_enabled(const WayButton& way, const OperatorModel& model) {
        const ButtonState& state = model.*way.state;
        if (state.enabled) return way.action;
        say(std::string(way.label) + " is not possible now: " + state.why_not + ".");
        return OperatorAction::none;
    }

    OperatorAction draw_buttons(const Pen& pen, const OperatorModel& model) {
        const float gap = place.gap, width = (place.buttons.width - 3 * gap) / 4;
        OperatorAction wanted = OperatorAction::none;
        Box box = place.buttons;
        box.width = width;
        for (const WayButton& way : kWay) {
            controls[way.action] = box;
            const bool leads_on = model.next == way.action;
            const ButtonLook look{false, leads_on, keys_of_button(way.key, leads_on)};
            if (button(pen, box, way.label, model.*way.state, look)) wanted = way.action;
            if (!(model.*way.state).enabled && ImGui::IsItemHovered() && ImGui::IsMouseReleased(0))
                if_enabled(way, model);
            box.x += width + gap;
        }
        controls[OperatorAction::dark] = place.dark;
        const ImVec2 mouse = ImGui::GetIO().MousePos;
        const bool hovered = place.dark.contains(mouse.x, mouse.y);
        draw_dark_button(pen, place.dark, hovered, hovered && ImGui::GetIO().MouseDown[0], key_text(KeyMeaning::dark));
        return wanted;
    }

    /// A press on the table opens the page with all of it.
    void draw_plan_table(const Pen& pen, const OperatorModel& model) {
        const ImVec2 mouse = ImGui::GetIO().MousePos;
        if (place.table.contains(mouse.x, mouse.y)) rows_scrolled -= ImGui::GetIO().MouseWheel;
        rows_scrolled = std::max(rows_scrolled, 0.0F);
        places["evidence"] = place.table;
        ImGui::SetCursorScreenPos({place.table.x, place.table.y});
        if (ImGui::InvisibleButton("evidence", {place.table.width, place.table.height}))
            middle->press(KeyMeaning::evidence, model);
        const std::optional<std::size_t> marked = middle->marked_row();
        const int from = static_cast<int>(rows_scrolled),
                  first = draw_table(pen, place.table, model, {from, marked, marked && marked != marked_row},
                                     ImGui::IsItemHovered());
        if (first != from) rows_scrolled = static_cast<float>(first);
        marked_row = marked;
    }

    void draw_cameras(const Pen& pen, const OperatorModel& model) {
        if (!model.left.refused && !model.right.refused) live_instead_of_refused = false;
        for (const auto& [camera, texture, box, word] :
             {std::tuple{&model.left, &left, place.left_camera, "left-camera"},
              std::tuple{&model.right, &right, place.right_camera, "right-camera"}}) {
            const bool refused = camera->refused && !live_instead_of_refused;
            const SeenPicture& shown = refused ? *camera->refused : camera->live;
            draw_camera(pen, box, *camera, refused,
                        texture_id(texture->take(shown.picture, static_cast<int>(box.width))));
            places[word] = box;
            ImGui::SetCursorScreenPos({box.x, box.y});
            if (ImGui::InvisibleButton(word, {box.width, box.height}) && camera->refused) change_picture(model);
        }
    }

    /// The refused pictures, or the live ones again.
    void change_picture(const OperatorModel& model) {
        if (model.left.refused || model.right.refused)
            live_instead_of_refused = !live_instead_of_refused;
        else
            say("There is no picture of a refused scan.");
    }

    /// Over the middle, so that the banner and DARK stay free.
    OperatorAction draw_question(const Pen& pen) {
        const Box& scene = place.scene;
        const float s = pen.scale, height = button_height(s, 84), pad = 24 * s;
        const Box card{scene.x + 0.08F * scene.width, scene.y + 0.2F * scene.height, 0.84F * scene.width,
                       height + 5 * line_height(pen.fonts.title) + 2 * pad};
        pen.panel(card, pen.theme->notice.fill, pen.theme->notice.edge, 3);
        float y = card.y + pad;
        const float width = card.width - 2 * pad;
        y += pen.paragraph(pen.fonts.title, pen.say("The light is on the patient. Make it dark and close the window?"),
                           {card.x + pad, y, width, 3 * line_height(pen.fonts.title)}, pen.theme->notice.text);
        pen.paragraph(pen.fonts.body, pen.say("The light goes on until you answer. DARK works as always."),
                      {card.x + pad, y + 8 * s, width, 2 * line_height(pen.fonts.body)}, pen.theme->notice.text);
        const Box row{card.x + pad, card.bottom() - pad - height, (width - pad) / 2, height};
        const Box other{row.right() + pad, row.y, row.width, height};
        places["close-window"] = row;
        places["stay"] = other;
        if (button(pen, row, "Dark and close", {true, {}}, {false, false, key_text(KeyMeaning::close_window)}))
            return OperatorAction::quit;
        if (button(pen, other, "Stay", {true, {}}, {false, true, keys_of_button(KeyMeaning::stay, true)}))
            asks_to_close = false;
        return OperatorAction::none;
    }

    OperatorAction draw(const Pen& pen, const OperatorModel& model) {
        places.clear();
        draw_header(pen, place, model);
        // While it is asked, what lies under the question must not be pressed instead of the answer.
        OperatorAction over_scene = OperatorAction::none;
        if (asks_to_close) {
            pen.panel(place.scene);
            over_scene = draw_question(pen);
        } else {
            over_scene = middle->draw(pen, place.scene, model);
        }
        draw_cameras(pen, model);
        draw_plan_table(pen, model);
        const OperatorAction wanted = draw_buttons(pen, model);
        draw_banner(pen, place.banner, model, steady_clock::now() > notice_until ? std::string{} : notice);
        return wanted == OperatorAction::none ? over_scene : wanted;
    }

    /// What the key that was pressed last means now.
    OperatorAction take_key(const OperatorModel& model) {
        KeyMeaning pressed = input.take();
        changed_meaning.look(model, steady_clock::now());
        if (asks_to_close) {
            if (pressed == KeyMeaning::stay || pressed == KeyMeaning::next) asks_to_close = false;
            return pressed == KeyMeaning::close_window ? OperatorAction::quit : OperatorAction::none;
        }
        if (pressed == KeyMeaning::next && changed_meaning.just_changed(steady_clock::now())) {
            say("What leads on has just changed: look, and press again.");
            return OperatorAction::none;
        }
        if (pressed == KeyMeaning::next) {
            if (model.next == OperatorAction::confirm) pressed = KeyMeaning::confirm;
            for (const WayButton& way : kWay)
                if (model.next == way.action) pressed = way.key;
            if (pressed == KeyMeaning::next) say("Nothing has to be pressed now.");
        }
        for (const WayButton& way : kWay)
            if (pressed == way.key) return if_enabled(way, model);
        if (pressed == KeyMeaning::refused_picture) change_picture(model);
        const OperatorAction wanted = middle->press(pressed, model);
        if (const std::string why = middle->why_not(); !why.empty()) say(why);
        return wanted;
    }

    /// The question whether the light may go out is not asked of darkness.
    void forget_question(const OperatorModel& model) {
        if (!asks_to_close || model.light_on) return;
        asks_to_close = false;
        drawn.reset();
    }

    /// True when the window is to be closed.
    bool take_close(const OperatorModel& model) {
        if (!gui.asked_to_close()) return false;
        if (!model.light_on) return true;
        gui.keep_open();
        asks_to_close = true;
        drawn.reset();  // the question is new
        return false;
    }
};

OperatorWindow::OperatorWindow(const WindowSettings& settings) : parts_(std::make_unique<Parts>(settings)) {}
OperatorWindow::~OperatorWindow() = default;

OperatorAction OperatorWindow::frame(const OperatorModel& model) {
    Parts& parts = *parts_;
    parts.gui.take_input(0);
    // Before anything is drawn: without graphics hardware that takes half a second, in which the light would go on.
    if (parts.input.take_dark()) {
        parts.gui.forget_presses();
        return OperatorAction::dark;
    }
    if (parts.take_close(model)) {
        parts.gui.keep_open();  // it has been said
        return OperatorAction::quit;
    }
    parts.forget_question(model);
    OperatorAction wanted = OperatorAction::none;
    if (parts.must_draw(model)) {
        const OperatorAction by_key = parts.take_key(model);
        if (by_key != OperatorAction::none) parts.notice.clear();
        if (steady_clock::now() > parts.notice_until) parts.notice.clear();
        parts.gui.frame([&](const Pen& pen, float width, float height) {
            parts.place = layout_of(static_cast<int>(width), static_cast<int>(height));
            wanted = parts.draw(pen, model);
        });
        ++parts.frames;
        parts.drawn = model;
        if (by_key != OperatorAction::none) wanted = by_key;
    }
    return wanted;
}

void OperatorWindow::say(const std::string& answer) {
    if (answer.empty()) return;
    parts_->say(answer);
    parts_->drawn.reset();
}

const std::string& OperatorWindow::answer() const {
    return parts_->notice;
}

void OperatorWindow::open_evidence() {
    parts_->middle->press(KeyMeaning::evidence, {});
    parts_->drawn.reset();
}

void OperatorWindow::open_views() {
    parts_->middle->press(KeyMeaning::views, {});
    parts_->drawn.reset();
}

void OperatorWindow::rest(double longest_s) {
    constexpr auto kLeast = std::chrono::milliseconds(5);  // while a mouse moves, too: the light is made beside it
    if (parts_->gui.touched())
        std::this_thread::sleep_for(kLeast);
    else
        parts_->gui.take_input(longest_s);
}

bool OperatorWindow::keyboard_is_elsewhere() const {
    return parts_->gui.keyboard_is_elsewhere();
}

bool OperatorWindow::put_away() const {
    return parts_->gui.put_away();
}

std::size_t OperatorWindow::frames_drawn() const {
    return parts_->frames;
}

RgbImage OperatorWindow::screenshot() {
    return parts_->gui.screenshot();
}

SceneView OperatorWindow::view() const {
    return parts_->middle->scene().view();
}

void OperatorWindow::set_view(const SceneView& view) {
    parts_->middle->scene().set_view(view);
}

void OperatorWindow::open_landmarks(const std::vector<PointPair>& pairs) {
    parts_->gui.make_current();
    parts_->middle->open_landmarks().clicks().set_pairs(pairs);
}

std::vector<PointPair> OperatorWindow::landmarks() const {
    const LandmarkPanel* const panel = parts_->middle->landmarks();
    return panel ? panel->clicks().pairs() : std::vector<PointPair>{};
}

std::optional<std::size_t> OperatorWindow::item_wanted() const {
    return parts_->middle->item_wanted();
}

FitView OperatorWindow::fit_view() const {
    return parts_->middle->fit_view;
}

void OperatorWindow::set_fit_view(FitView view) {
    parts_->middle->fit_view = view;
}

std::array<int, 4> OperatorWindow::place_of(OperatorAction control) const {
    return whole_pixels(control == OperatorAction::confirm ? parts_->middle->place_of("confirm")
                                                           : parts_->controls[control]);
}

std::array<int, 4> OperatorWindow::place_of(const std::string& button) const {
    const auto own = parts_->places.find(button);
    return whole_pixels(own == parts_->places.end() ? parts_->middle->place_of(button) : own->second);
}

}  // namespace planlight
