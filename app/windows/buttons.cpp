#include <imgui.h>

#include <algorithm>
#include <string>
#include <vector>

#include "app/windows/panels.h"

namespace planlight {
namespace {

/// "Space · B" with the keys' names in the window's language. Where there is no room for all, those in the middle give
/// way: the letter and the pedal's key stay.
std::string keys_in_words(const Pen& pen, const std::string& keys, float width) {
    static const std::string kBetween = " · ";
    std::vector<std::string> words;
    for (std::size_t at = 0; at <= keys.size();) {
        const std::size_t end = std::min(keys.find(kBetween, at), keys.size());
        words.push_back(pen.say(keys.substr(at, end - at)));
        at = end + kBetween.size();
    }
    const auto joined = [&] {
        std::string line = words.front();
        for (std::size_t i = 1; i < words.size(); ++i) line += kBetween + words[i];
        return line;
    };
    while (words.size() > 1 && text_width(pen.fonts.small, joined()) > width)
        words.erase(words.begin() + static_cast<std::ptrdiff_t>(words.size() / 2));
    return joined();
}

void draw_button(const Pen& pen, const Box& box, const std::string& label, const ButtonState& state,
                 const ButtonLook& look, bool hovered, bool held) {
    const bool blue = held || look.chosen || look.leads_on;
    const ImU32 fill = !state.enabled ? pen.theme->disabled
                       : hovered      ? pen.theme->hovered
                       : blue         ? pen.theme->active
                                      : pen.theme->control;
    const ImU32 edge = !state.enabled  ? pen.theme->edge
                       : look.leads_on ? pen.theme->leads_edge
                                       : pen.theme->control_edge;
    pen.panel(box, fill, edge, !state.enabled ? 1 : look.leads_on ? 4 : 2);
    const float pad = 8 * pen.scale;
    if (state.enabled) {
        const auto fits = [&](const ImFont* font) { return text_width(font, label) <= box.width - 2 * pad; };
        const ImFont* const font = fits(pen.fonts.title)    ? pen.fonts.title
                                   : fits(pen.fonts.strong) ? pen.fonts.strong
                                                            : pen.fonts.small;
        pen.line(font, label, box.x + pad, box.y + (look.key.empty() ? 0.5F : 0.40F) * box.height, box.width - 2 * pad,
                 pen.theme->text, Pen::Side::centre);
        pen.line(pen.fonts.small, keys_in_words(pen, look.key, box.width - 2 * pad), box.x + pad,
                 box.y + 0.77F * box.height, box.width - 2 * pad, look.leads_on ? pen.theme->text : pen.theme->quiet,
                 Pen::Side::centre);
        return;
    }
    const float height = line_height(pen.fonts.small);
    const std::string why = pen.say(state.why_not);
    const std::size_t lines = broken(pen.fonts.small, why, box.width - 2 * pad, 2).size();
    const float all = line_height(pen.fonts.strong) + height * static_cast<float>(lines);
    const float top = box.y + (box.height - all) / 2;
    pen.line(pen.fonts.strong, label, box.x + pad, top + line_height(pen.fonts.strong) / 2, box.width - 2 * pad,
             pen.theme->disabled_text, Pen::Side::centre);
    pen.paragraph(pen.fonts.small, why,
                  {box.x + pad, top + line_height(pen.fonts.strong), box.width - 2 * pad, 2 * height + 1},
                  pen.theme->quiet, Pen::Side::centre);
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
              held      ? pen.theme->badge_held
              : hovered ? pen.theme->badge_hovered
                        : pen.theme->badge,
              pen.theme->badge_edge, 2);
    const float top = box.y + 0.38F * box.height;
    pen.line(pen.fonts.number, pen.say("DARK"), box.x, top, box.width, pen.theme->badge_text, Pen::Side::centre);
    pen.line(pen.fonts.small, keys_in_words(pen, keys, box.width), box.x, box.y + 0.78F * box.height, box.width,
             pen.theme->badge_quiet, Pen::Side::centre);
}

}  // namespace planlight
