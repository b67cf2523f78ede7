#include <algorithm>
#include <array>
#include <cmath>

#include "app/windows/panels.h"

namespace planlight {
namespace {

constexpr std::array<const char*, 6> kSteps{"Case", "Rig", "Scan", "Match", "Verify", "Project"};

void draw_step(const Pen& pen, const Box& chip, std::size_t index, StepState state) {
    const bool active = state == StepState::active;
    pen.panel(chip, active ? theme::kActive : theme::kPanel, active ? theme::kBlue : theme::kEdge, active ? 2 : 1);
    const float radius = std::round(16 * pen.scale), middle_y = chip.y + chip.height / 2;
    const ImVec2 middle(chip.x + 12 * pen.scale + radius, middle_y);
    const float text_x = middle.x + radius + 8 * pen.scale;
    const float text_room = chip.right() - 6 * pen.scale - text_x;
    if (state == StepState::done) {
        pen.list->AddCircleFilled(middle, radius, IM_COL32(31, 142, 86, 255), 32);
        pen.tick(middle, radius * 0.9F, IM_COL32_WHITE);
    } else if (state == StepState::attention) {
        pen.triangle({middle.x, middle.y + 0.1F * radius}, radius, theme::kAmber);
        pen.line(pen.fonts.strong, "!", middle.x - radius, middle_y + 0.2F * radius, 2 * radius, IM_COL32_BLACK,
                 Pen::Side::centre);
    } else {
        pen.list->AddCircleFilled(middle, radius, active ? theme::kBackground : theme::kControl, 32);
        pen.line(active ? pen.fonts.strong : pen.fonts.small, std::to_string(index + 1), middle.x - radius, middle_y,
                 2 * radius, active ? theme::kText : theme::kQuiet, Pen::Side::centre);
    }
    const bool waiting = state == StepState::waiting;
    pen.line(active ? pen.fonts.strong : pen.fonts.body, kSteps[index], text_x, middle_y, text_room,
             waiting ? theme::kQuiet : theme::kText);
}

}  // namespace

void draw_header(const Pen& pen, const WindowLayout& place, const OperatorModel& model) {
    const Box& title = place.title;
    const bool two_lines = broken(pen.fonts.small, model.case_subtitle, title.width, 2).size() > 1;
    const float title_height = line_height(pen.fonts.title);
    const float first =
        two_lines ? title.y + title_height / 2 - 2 * pen.scale : title.y + (title.height - title_height) / 2;
    pen.line(pen.fonts.title, model.case_title, title.x, first, title.width, theme::kText);
    const float top = first + title_height / 2;
    pen.paragraph(pen.fonts.small, model.case_subtitle,
                  {title.x, top, title.width, title.bottom() + 4 * pen.scale - top}, theme::kQuiet);

    const Box& steps = place.steps;
    const float gap = 8 * pen.scale, chip_height = std::min(steps.height, std::round(60 * pen.scale));
    const float extra = 56 * pen.scale;  // circle and margins, beside the word
    float words = 0;
    for (const char* step : kSteps) words += text_width(pen.fonts.strong, step) + extra;
    const float spare = std::max(0.0F, (steps.width - 5 * gap - words) / 6);
    const float more = std::min(spare, 20 * pen.scale);
    float x = steps.x + 3 * (spare - more);
    for (std::size_t i = 0; i < kSteps.size(); ++i) {
        const float width = text_width(pen.fonts.strong, kSteps[i]) + extra + more;
        draw_step(pen, {x, steps.y + (steps.height - chip_height) / 2, width, chip_height}, i, model.steps[i]);
        x += width + gap;
    }
}

}  // namespace planlight
