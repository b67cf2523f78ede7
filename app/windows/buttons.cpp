#include <imgui.h>

#include "app/windows/panels.h"

namespace planlight {
namespace {

void draw_button(const Pen& pen, const Box& box, const std::string& label, const ButtonState& state, bool hovered,
                 bool held) {
    const ImU32 fill = !state.enabled ? IM_COL32(22, 25, 32, 255)
                       : held         ? theme::kActive
                       : hovered      ? theme::kHovered
                                      : theme::kControl;
    pen.panel(box, fill, state.enabled ? IM_COL32(96, 112, 140, 255) : theme::kEdge, state.enabled ? 2 : 1);
    const float pad = 8 * pen.scale;
    if (state.enabled) {
        pen.line(pen.fonts.title, label, box.x + pad, box.y + box.height / 2, box.width - 2 * pad, theme::kText,
                 Pen::Side::centre);
        return;
    }
    const float height = line_height(pen.fonts.small);
    const std::size_t lines = broken(pen.fonts.small, state.why_not, box.width - 2 * pad, 2).size();
    const float all = line_height(pen.fonts.strong) + height * static_cast<float>(lines);
    const float top = box.y + (box.height - all) / 2;
    pen.line(pen.fonts.strong, label, box.x + pad, top + line_height(pen.fonts.strong) / 2, box.width - 2 * pad,
             IM_COL32(120, 128, 142, 255), Pen::Side::centre);
    pen.paragraph(pen.fonts.small, state.why_not,
                  {box.x + pad, top + line_height(pen.fonts.strong), box.width - 2 * pad, 2 * height + 1},
                  theme::kQuiet, Pen::Side::centre);
}

}  // namespace

bool button(const Pen& pen, const Box& box, const std::string& label, const ButtonState& state, bool chosen) {
    ImGui::SetCursorScreenPos({box.x, box.y});
    const bool pressed = ImGui::InvisibleButton(label.c_str(), {box.width, box.height});
    draw_button(pen, box, label, state, ImGui::IsItemHovered(), chosen || ImGui::IsItemActive());
    return pressed && state.enabled;
}

void draw_dark_button(const Pen& pen, const Box& box, bool hovered, bool held) {
    pen.panel(box,
              held      ? IM_COL32(150, 156, 168, 255)
              : hovered ? IM_COL32_WHITE
                        : IM_COL32(222, 226, 234, 255),
              IM_COL32_WHITE, 2);
    const float top = box.y + 0.38F * box.height;
    pen.line(pen.fonts.number, "DARK", box.x, top, box.width, IM_COL32(12, 14, 18, 255), Pen::Side::centre);
    pen.line(pen.fonts.small, "Space · B · Esc", box.x, box.y + 0.78F * box.height, box.width,
             IM_COL32(52, 58, 70, 255), Pen::Side::centre);
}

}  // namespace planlight
