#include "app/windows/view_buttons.h"

#include <algorithm>
#include <cmath>

#include "app/windows/orientation.h"
#include "app/windows/panels.h"

namespace planlight {
namespace {

struct Preset {
    const char* label;
    const char* word;  ///< of the place, for tests
    KeyMeaning key;
};
constexpr int kColumns = 3, kRows = 3;
/// Row by row; the patient's right stands at the left, as face to face.
constexpr Preset kPresets[] = {
    {"A", "view-A", KeyMeaning::view_front},
    {"P", "view-P", KeyMeaning::view_back},
    {"S", "view-S", KeyMeaning::view_above},
    {"R", "view-R", KeyMeaning::view_right},
    {"L", "view-L", KeyMeaning::view_left},
    {"Reset", "view-reset", KeyMeaning::view_reset},
    {"Projector", "view-projector", KeyMeaning::view_projector},
    {"Surgeon", "view-surgeon", KeyMeaning::view_surgeon},
};

bool far_from(const SceneView& a, const SceneView& b) {
    constexpr double kSeen = 0.01;  // radians
    const ViewAxes from = axes_of(a), to = axes_of(b);
    return (from.backward_in_ct - to.backward_in_ct).norm() > kSeen || (from.up_in_ct - to.up_in_ct).norm() > kSeen;
}

/// Turned as that one; as near, and as shifted, as this one is.
SceneView turned_as(const SceneView& other, SceneView view) {
    view.azimuth = other.azimuth, view.elevation = other.elevation, view.roll = other.roll;
    return view;
}

}  // namespace

float ViewButtons::height(float scale) {
    return kRows * (button_height(scale) + 8 * scale) + 8 * scale;
}

std::string ViewButtons::press(KeyMeaning key, const OperatorModel& model, ScenePane& scene) {
    if (key == KeyMeaning::views) open_ = !open_;
    const Preset* const preset =
        std::find_if(std::begin(kPresets), std::end(kPresets), [&](const Preset& p) { return p.key == key; });
    if (preset == std::end(kPresets)) return {};
    if (key == KeyMeaning::view_reset)
        scene.look(scene.first_view());
    else if (key == KeyMeaning::view_projector && !model.projector_view)
        return "The projector's view is known once the patient is found.";
    else if (key == KeyMeaning::view_surgeon && !model.surgeon_view)
        return "Where the surgeon stands is not known.";
    else if (key == KeyMeaning::view_projector)
        scene.look(*model.projector_view);
    else if (key == KeyMeaning::view_surgeon)
        scene.look(*model.surgeon_view);
    else
        scene.look(standard_view(preset->label[0]));
    chosen_ = key;
    looked_ = scene.view();
    return {};
}

void ViewButtons::follow(const OperatorModel& model, ScenePane& scene) {
    if (chosen_ == KeyMeaning::none) return;
    if (far_from(scene.view(), looked_)) {
        chosen_ = KeyMeaning::none;
        return;
    }
    if (chosen_ != KeyMeaning::view_projector || !model.projector_view) return;
    if (!far_from(*model.projector_view, looked_)) return;
    scene.look(turned_as(*model.projector_view, scene.view()));
    looked_ = scene.view();
}

void ViewButtons::draw_opener(const Pen& pen, const Box& box) {
    places_.clear();
    places_["views"] = box;
    if (button(pen, box, "Views", {true, {}}, {open_, false, key_text(KeyMeaning::views)})) open_ = !open_;
}

void ViewButtons::draw(const Pen& pen, const Box& place, const OperatorModel& model, ScenePane& scene) {
    if (!open_) return;
    const float gap = 8 * pen.scale;
    const Box whole{place.x, place.y, place.width, button_height(pen.scale)};
    Box box = whole;
    box.width = (whole.width - (kColumns - 1) * gap) / kColumns;
    int column = 0;
    const auto next = [&] {
        box.x += box.width + gap;
        if (++column % kColumns == 0) box.x = whole.x, box.y += box.height + gap;
    };
    for (const Preset& preset : kPresets) {
        places_[preset.word] = box;
        const bool known = (preset.key != KeyMeaning::view_projector || model.projector_view) &&
                           (preset.key != KeyMeaning::view_surgeon || model.surgeon_view);
        const ButtonState state{known, known ? "" : "not known yet"};
        if (button(pen, box, preset.label, state, {chosen_ == preset.key, false, key_text(preset.key)}))
            press(preset.key, model, scene);
        next();
    }
    places_["views-close"] = box;
    if (button(pen, box, "Close", {true, {}}, {false, false, key_text(KeyMeaning::views)})) open_ = false;
}

}  // namespace planlight
