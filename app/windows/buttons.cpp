#include <imgui.h>

#include <algorithm>

#include "app/windows/panels.h"

namespace planlight {
namespace {

/// "Space · B" with the keys' names in the window's language.
std::string keys_in_words(const Pen& pen, const std::string& keys) {
    static const std::string kBetween = " · ";
    std::string words;
    for (std::size_t at = 0; at <= keys.size();) {
        const std::size_t end = std::min(keys.find(kBetween, at), keys.size());
        words += (at == 0 ? "" : kBetween) + pen.say(keys.substr(at, end - at));
        at = end + kBetween.size();
    }
    return words;
}

void draw_button(const Pen& pen, const Box& box, const std::string& label, const ButtonState& state,
                 const ButtonLook& look, bool hovered, bool held) {
    const bool blue = held || look.chosen || look.leads_on;
    const ImU32 fill = !state.enabled ? IM_COL32(22, 25, 32, 255)
                       : hovered      ? theme::kHovered
                       : blue         ? theme::kActive
                                      : theme::kControl;
    const ImU32 edge = !state.enabled  ? theme::kEdge
                       : look.leads_on ? IM_COL32(130, 190, 255, 255)
                                       : IM_COL32(96, 112, 140, 255);
    pen.panel(box, fill, edge, !state.enabled ? 1 : look.leads_on ? 4 : 2);
    const float pad = 8 * pen.scale;
    if (state.enabled) {
        const bool fits = text_width(pen.fonts.title, label) <= box.width - 2 * pad;
        pen.line(fits ? pen.fonts.title : pen.fonts.strong, label, box.x + pad,
                 box.y + (look.key.empty() ? 0.5F : 0.40F) * box.height, box.width - 2 * pad, theme::kText,
                 Pen::Side::centre);
        pen.line(pen.fonts.small, keys_in_words(pen, look.key), box.x + pad, box.y + 0.77F * box.height,
                 box.width - 2 * pad, look.leads_on ? theme::kText : theme::kQuiet, Pen::Side::centre);
        return;
    }
    const float height = line_height(pen.fonts.small);
    const std::string why = pen.say(state.why_not);
    const std::size_t lines = broken(pen.fonts.small, why, box.width - 2 * pad, 2).size();
    const float all = line_height(pen.fonts.strong) + height * static_cast<float>(lines);
    const float top = box.y + (box.height - all) / 2;
    pen.line(pen.fonts.strong, label, box.x + pad, top + line_height(pen.fonts.strong) / 2, box.width - 2 * pad,
             IM_COL32(120, 128, 142, 255), Pen::Side::centre);
    pen.paragraph(pen.fonts.small, why,
                  {box.x + pad, top + line_height(pen.fonts.strong), box.width - 2 * pad, 2 * height + 1},
                  theme::kQuiet, Pen::Side::centre);
}

}  // namespace

bool button(const Pen& pen, const Box& box, const std::string& label, const ButtonState& state,
            const ButtonLook& look) {
    ImGui::SetCursorScreenPos({box.x, box.y});
    const bool pressed = ImGui::InvisibleButton(label.c_str(), {box.width, box.height});
    draw_button(pen, box, pen.say(label), state, look, ImGui::IsItemHovered(), ImGui::IsItemActive());
    return pressed && state.enabled;
}

void draw_dark_button(const Pen& pen, const Box& box, bool hovered, bool held, const std::string& keys) {
    pen.panel(box,
              held      ? IM_COL32(150, 156, 168, 255)
              : hovered ? IM_COL32_WHITE
                        : IM_COL32(222, 226, 234, 255),
              IM_COL32_WHITE, 2);
    const float top = box.y + 0.38F * box.height;
    pen.line(pen.fonts.number, pen.say("DARK"), box.x, top, box.width, IM_COL32(12, 14, 18, 255), Pen::Side::centre);
    pen.line(pen.fonts.small, keys_in_words(pen, keys), box.x, box.y + 0.78F * box.height, box.width,
             IM_COL32(52, 58, 70, 255), Pen::Side::centre);
}

}  // namespace planlight
