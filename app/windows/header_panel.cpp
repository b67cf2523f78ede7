#include <algorithm>
#include <array>
#include <cmath>

#include "app/windows/panels.h"

namespace planlight {
namespace {

constexpr std::array<const char*, 6> kSteps{"Case", "Rig", "Scan", "Match", "Verify", "Project"};

/// The words of the program beside names that stay; a name alone is never a word, whatever it is.
std::string around_names(const Pen& pen, const std::string& text) {
    return text.find(" · ") == std::string::npos ? text : pen.say(text);
}

void draw_step(const Pen& pen, const Box& chip, std::size_t index, StepState state) {
    const bool active = state == StepState::active;
    pen.panel(chip, active ? pen.theme->active : pen.theme->panel, active ? pen.theme->blue : pen.theme->edge,
              active ? 2 : 1);
    const float radius = std::round(16 * pen.scale), middle_y = chip.y + chip.height / 2;
    const ImVec2 middle(chip.x + 12 * pen.scale + radius, middle_y);
    const float text_x = middle.x + radius + 8 * pen.scale;
    const float text_room = chip.right() - 6 * pen.scale - text_x;
    if (state == StepState::done) {
        pen.list->AddCircleFilled(middle, radius, pen.theme->done, 32);
        pen.tick(middle, radius * 0.9F, IM_COL32_WHITE);
    } else if (state == StepState::attention) {
        pen.triangle({middle.x, middle.y + 0.1F * radius}, radius, pen.theme->amber);
        pen.line(pen.fonts.strong, "!", middle.x - radius, middle_y + 0.2F * radius, 2 * radius, pen.theme->panel,
                 Pen::Side::centre);
    } else {
        pen.list->AddCircleFilled(middle, radius, active ? pen.theme->background : pen.theme->control, 32);
        pen.line(active ? pen.fonts.strong : pen.fonts.small, std::to_string(index + 1), middle.x - radius, middle_y,
                 2 * radius, active ? pen.theme->text : pen.theme->quiet, Pen::Side::centre);
    }
    const bool waiting = state == StepState::waiting;
    pen.line(active ? pen.fonts.strong : pen.fonts.body, pen.say(kSteps[index]), text_x, middle_y, text_room,
             waiting ? pen.theme->quiet : pen.theme->text);
}

/// The side in large letters at the right end of the box; returns the width that it takes.
float draw_side(const Pen& pen, const Box& box, const std::string& which) {
    if (which.empty()) return 0;
    const std::string side = pen.say(which), caption = pen.say("side of the plan");
    const float pad = 12 * pen.scale;
    const float width = std::max(text_width(pen.fonts.number, side), text_width(pen.fonts.small, caption)) + 2 * pad;
    const Box badge{box.right() - width, box.y + 0.08F * box.height, width, 0.84F * box.height};
    pen.panel(badge, pen.theme->badge, pen.theme->badge_edge, 2);
    pen.line(pen.fonts.number, side, badge.x, badge.y + 0.42F * badge.height, badge.width, pen.theme->badge_text,
             Pen::Side::centre);
    pen.line(pen.fonts.small, caption, badge.x + 2, badge.y + 0.82F * badge.height, badge.width - 4,
             pen.theme->badge_quiet, Pen::Side::centre);
    return width + pad;
}

}  // namespace

void draw_header(const Pen& pen, const WindowLayout& place, const OperatorModel& model) {
    Box title = place.title;
    title.width -= draw_side(pen, title, model.case_side);
    const float large = line_height(pen.fonts.title), small = line_height(pen.fonts.small);
    const std::string last = model.simulated ? pen.say("SIMULATED ROOM") : around_names(pen, model.case_subtitle);
    const float plan = model.case_plan.empty() ? 0 : small, rest = last.empty() ? 0 : small;
    float y = title.y + std::max(0.0F, (title.height - large - plan - rest) / 2);
    pen.line(pen.fonts.title, model.case_title, title.x, y + large / 2, title.width, pen.theme->text);
    y += large;
    pen.line(pen.fonts.small, around_names(pen, model.case_plan), title.x, y + plan / 2, title.width, pen.theme->text);
    y += plan;
    pen.line(model.simulated ? pen.fonts.strong : pen.fonts.small, last, title.x, y + rest / 2, title.width,
             model.simulated ? pen.theme->amber : pen.theme->quiet);

    const Box& steps = place.steps;
    const float gap = 8 * pen.scale, chip_height = std::min(steps.height, std::round(60 * pen.scale));
    const float extra = 56 * pen.scale;  // circle and margins, beside the word
    float words = 0;
    for (const char* step : kSteps) words += text_width(pen.fonts.strong, pen.say(step)) + extra;
    const float spare = std::max(0.0F, (steps.width - 5 * gap - words) / 6);
    const float more = std::min(spare, 20 * pen.scale);
    float x = steps.x + 3 * (spare - more);
    for (std::size_t i = 0; i < kSteps.size(); ++i) {
        const float width = text_width(pen.fonts.strong, pen.say(kSteps[i])) + extra + more;
        draw_step(pen, {x, steps.y + (steps.height - chip_height) / 2, width, chip_height}, i, model.steps[i]);
        x += width + gap;
    }
}

}  // namespace planlight
