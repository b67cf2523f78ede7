#include "app/windows/review_window.h"

#include <GLFW/glfw3.h>
#include <imgui.h>

#include <deque>
#include <map>

#include "app/windows/camera_texture.h"
#include "app/windows/gui_window.h"
#include "app/windows/panels.h"
#include "app/windows/review_panels.h"
#include "app/windows/scene_pane.h"

namespace planlight {
namespace {

using Kind = ReviewWish::Kind;

struct StepButton {
    Kind kind;
    const char* words;
    const char* shown_key;
    int key, other_key;
};
constexpr StepButton kSteps[] = {
    {Kind::begin, "Beginning", "Home", GLFW_KEY_HOME, GLFW_KEY_HOME},
    {Kind::event_before, "Event before", "↑", GLFW_KEY_UP, GLFW_KEY_PAGE_UP},
    {Kind::frame_before, "Frame before", "←", GLFW_KEY_LEFT, GLFW_KEY_LEFT},
    {Kind::frame_after, "Frame after", "→", GLFW_KEY_RIGHT, GLFW_KEY_RIGHT},
    {Kind::event_after, "Event after", "↓", GLFW_KEY_DOWN, GLFW_KEY_PAGE_DOWN},
    {Kind::end, "End", "End", GLFW_KEY_END, GLFW_KEY_END},
};

constexpr const char* kSnapshotKey = "S saves a picture";

Kind step_of(int key) {
    for (const StepButton& step : kSteps)
        if (key == step.key || key == step.other_key) return step.kind;
    if (key == GLFW_KEY_S) return Kind::snapshot;
    return key == GLFW_KEY_Q || key == GLFW_KEY_ESCAPE ? Kind::quit : Kind::none;
}

/// The place that lies nearest to a line of sight, 8 mm beside it at most.
std::optional<std::size_t> place_near(const ReviewModel& model, const Ray& sight) {
    double least_mm = 8;
    std::optional<std::size_t> nearest;
    for (std::size_t i = 0; i < model.places.size(); ++i) {
        const Eigen::Vector3d to = model.places[i].p_in_ct - sight.origin;
        const double beside_mm = to.cross(sight.direction).norm();
        if (beside_mm > least_mm) continue;
        least_mm = beside_mm;
        nearest = i;
    }
    return nearest;
}

ReviewWish pick_of(const ReviewModel& model, std::size_t place) {
    return {Kind::pick, 0, model.places[place].p_in_ct};
}

}  // namespace

struct ReviewWindow::Parts {
    std::deque<Kind> pressed;  // by keys
    bool whole = false, light_wanted = false, looked = false;
    GuiWindow gui;
    CameraTexture left{gui}, right{gui};
    ColourTexture light{gui};
    std::unique_ptr<ScenePane> head;
    std::shared_ptr<const ReviewModel> drawn;
    std::map<std::string, Box> places;

    explicit Parts(const WindowSettings& settings)
        : gui(settings, {[this](int key, int) { take_key(key); }, {}, [this](int key) { take_held(key); }}) {
        gui.make_current();
        head = std::make_unique<ScenePane>(gui.font_files(), [this] { gui.make_current(); });
    }
    Parts(const Parts&) = delete;
    Parts& operator=(const Parts&) = delete;

    void take_key(int key) {
        if (key == GLFW_KEY_Z) whole = !whole;
        if (key == GLFW_KEY_V) light_wanted = !light_wanted;
        if (const Kind step = step_of(key); step != Kind::none) pressed.push_back(step);
    }
    /// A held key does not run ahead of what is drawn.
    void take_held(int key) {
        const Kind step = step_of(key);
        const bool once = step == Kind::quit || step == Kind::snapshot;
        if (step != Kind::none && !once && pressed.empty()) pressed.push_back(step);
    }

    bool must_draw(const std::shared_ptr<const ReviewModel>& model) const {
        return gui.touched() || model != drawn || !pressed.empty() || head->wants_frame();
    }

    /// Whether it was pressed in that place, and where.
    std::optional<ImVec2> press_in(const char* name, const Box& box) {
        places[name] = box;
        ImGui::SetCursorScreenPos({box.x, box.y});
        if (ImGui::InvisibleButton(name, {box.width, box.height})) return ImGui::GetIO().MousePos;
        return std::nullopt;
    }

    void draw_cameras(const Pen& pen, const ReviewLayout& place, const ReviewModel& model, ReviewWish& wish) {
        for (std::size_t i = 0; i < 2; ++i) {
            const Box& box = i == 0 ? place.left : place.right;
            const auto press = press_in(i == 0 ? "left" : "right", box);
            // As large as it is: a part of it may fill the place.
            const auto& picture = model.cameras[i].picture;
            const unsigned texture = (i == 0 ? left : right).take(picture, picture ? picture->width : 0);
            const auto pixel = draw_review_camera(pen, box, model, i, whole, texture_id(texture), press);
            if (!pixel) continue;
            if (const auto picked = planlight::place_near(model, i, *pixel)) wish = pick_of(model, *picked);
        }
    }

    void draw_head(const Pen& pen, const Box& box, const ReviewModel& model, ReviewWish& wish) {
        places["head"] = box;
        if (light_wanted || !model.scene)
            return draw_review_light(pen, box, model, texture_id(light.take(model.light)));
        if (!looked) head->set_view(model.by_projector);
        looked = true;
        const auto press = head->take_mouse("head", box);
        head->draw(pen, box, *model.scene);
        if (!press) return;
        if (const auto picked = place_near(model, head->sight(*press))) wish = pick_of(model, *picked);
    }

    void draw_buttons(const Pen& pen, const ReviewLayout& place, const ReviewModel& model, ReviewWish& wish) {
        const ButtonState read{model.line != nullptr, "it is being read"}, free{true, {}};
        auto box = place.buttons.begin();
        const auto is_pressed = [&](const char* words, const ButtonState& state, const char* key, bool chosen = false) {
            places[words] = *box;
            return button(pen, *box++, words, state, {chosen, false, key});
        };
        for (const StepButton& step : kSteps)
            if (is_pressed(step.words, read, step.shown_key)) wish.kind = step.kind;
        if (is_pressed("Whole picture", free, "Z", whole)) whole = !whole;
        if (is_pressed("Projector", free, "V", light_wanted)) light_wanted = !light_wanted;
    }

    void take_time_line(const Pen& pen, const Box& box, const ReviewModel& model, ReviewWish& wish) {
        press_in("time line", box);
        const ImGuiIO& io = ImGui::GetIO();
        if (model.line && ImGui::IsItemActive() && io.MouseDown[0])
            wish = {Kind::to_time, time_at(box, pen, model, io.MousePos.x)};
        if (ImGui::IsItemHovered() && io.MouseWheel != 0)
            wish.kind = io.MouseWheel > 0 ? Kind::frame_before : Kind::frame_after;
    }

    ReviewWish draw(const Pen& pen, const ReviewModel& model, float w, float h) {
        const ReviewLayout place = review_layout(w, h);
        const float s = pen.scale;
        ReviewWish wish;
        const std::string time = (model.frame_s ? time_text(*model.frame_s) : "-") +
                                 (model.line ? " / " + time_text(model.line->lasted_s) : "");
        const float time_width = text_width(pen.fonts.number, time) + 8 * s,
                    words = place.title.width - time_width - 20 * s;
        pen.line(pen.fonts.title, model.title, place.title.x + 8 * s, place.title.y + 14 * s, words, pen.theme->text);
        const std::string below = model.line ? model.subtitle + " · " + pen.say(kSnapshotKey) : model.subtitle;
        pen.line(pen.fonts.small, below, place.title.x + 8 * s, place.title.y + 44 * s, words, pen.theme->quiet);
        pen.line(pen.fonts.number, time, place.title.right() - time_width, place.title.y + place.title.height / 2, 0,
                 pen.theme->text);
        draw_cameras(pen, place, model, wish);
        draw_head(pen, place.head, model, wish);
        draw_review_words(pen, place.words, model);
        take_time_line(pen, place.time_line, model, wish);
        draw_time_line(pen, place.time_line, model);
        draw_buttons(pen, place, model, wish);
        return wish;
    }
};

ReviewWindow::ReviewWindow(const WindowSettings& settings) : parts_(std::make_unique<Parts>(settings)) {}
ReviewWindow::~ReviewWindow() = default;

ReviewWish ReviewWindow::frame(const std::shared_ptr<const ReviewModel>& model) {
    Parts& parts = *parts_;
    parts.gui.take_input(0);
    if (parts.gui.asked_to_close()) return {Kind::quit};
    ReviewWish wish;
    if (!parts.must_draw(model)) return wish;
    parts.gui.frame([&](const Pen& pen, float w, float h) { wish = parts.draw(pen, *model, w, h); });
    parts.drawn = model;
    if (parts.pressed.empty()) return wish;
    wish = {parts.pressed.front()};
    parts.pressed.pop_front();
    return wish;
}

void ReviewWindow::rest(double longest_s) {
    if (!parts_->gui.touched() && parts_->pressed.empty()) parts_->gui.take_input(longest_s);
}

RgbImage ReviewWindow::screenshot() {
    return parts_->gui.screenshot();
}

std::array<int, 4> ReviewWindow::place_of(const std::string& control) const {
    const auto place = parts_->places.find(control);
    return place == parts_->places.end() ? std::array<int, 4>{} : whole_pixels(place->second);
}

}  // namespace planlight
