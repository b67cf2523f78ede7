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

constexpr const char* kSideCaption = "side of the plan";

/// What the side takes of the title's width.
float side_width(const Pen& pen, const std::string& which) {
    if (which.empty()) return 0;
    return std::max(text_width(pen.fonts.number, pen.say(which)), text_width(pen.fonts.small, pen.say(kSideCaption))) +
           36 * pen.scale;
}

/// The side in large letters at the right end of the box.
void draw_side(const Pen& pen, const Box& box, const std::string& which) {
    if (which.empty()) return;
    const std::string side = pen.say(which), caption = pen.say(kSideCaption);
    const float width = side_width(pen, which) - 12 * pen.scale;
    const Box badge{box.right() - width, box.y + 0.08F * box.height, width, 0.84F * box.height};
    pen.panel(badge, pen.theme->badge, pen.theme->badge_edge, 2);
    pen.line(pen.fonts.number, side, badge.x, badge.y + 0.42F * badge.height, badge.width, pen.theme->badge_text,
             Pen::Side::centre);
    pen.line(pen.fonts.small, caption, badge.x + 2, badge.y + 0.82F * badge.height, badge.width - 4,
             pen.theme->badge_quiet, Pen::Side::centre);
}

/// In place of the subtitle; null: the room is real.
const char* unreal_words(RoomKind kind) {
    switch (kind) {
        case RoomKind::simulated:
            return "SIMULATED ROOM";
        case RoomKind::recorded:
            return "RECORDED PICTURES";
        case RoomKind::real:
            break;
    }
    return nullptr;
}

/// ", version 3 · series of 2012-09-14" of "A long name, version 3 · series of 2012-09-14".
std::string after_name(const std::string& plan) {
    const std::size_t version = plan.rfind(", "), date = plan.rfind(" · ");
    const std::size_t end = version != std::string::npos && version < date ? version : date;
    return end == std::string::npos ? std::string() : plan.substr(end);
}

/// Room for enough of the plan's name beside its version and its date, which stay whole.
bool has_room_for(const ImFont* font, const std::string& plan, float width) {
    constexpr float kLeastOfName = 3;  // letters as wide as high
    return text_width(font, plan) <= width ||
           width - text_width(font, after_name(plan)) >= kLeastOfName * font->FontSize;
}

/// The plan in so much room: its name gives way; where not even that helps, the middle of all of it.
std::string plan_in(const ImFont* font, const std::string& plan, float width) {
    if (text_width(font, plan) <= width) return plan;
    if (!has_room_for(font, plan, width)) return shortened_in_the_middle(font, plan, width);
    const std::string tail = after_name(plan);
    return shortened_in_the_middle(font, plan.substr(0, plan.size() - tail.size()), width - text_width(font, tail)) +
           tail;
}

/// As many of the parts between dots, from the first on, as have room: a case's code is whole or not there.
std::string parts_in(const ImFont* font, std::string parts, float width) {
    while (text_width(font, parts) > width) {
        const std::size_t dot = parts.rfind(" · ");
        if (dot == std::string::npos) return {};
        parts.erase(dot);
    }
    return parts;
}

/// The case has no patient's name: its title is "Case " and its code, with which the subtitle begins.
bool is_code(const OperatorModel& model) {
    constexpr std::string_view kCase = "Case ";
    return model.case_title.starts_with(kCase) &&
           model.case_subtitle.starts_with(model.case_title.substr(kCase.size()) + " ");
}

/// Three lines: whose head, which plan, which room and case.
struct CaseLines {
    std::string patient, plan, unreal, rest;

    CaseLines(const Pen& pen, const OperatorModel& model)
        : patient(is_code(model) ? pen.say(model.case_title) : model.case_title),
          plan(around_names(pen, model.case_plan)),
          rest(around_names(pen, model.case_subtitle)) {
        if (const char* const words = unreal_words(model.room_kind)) unreal = pen.say(words);
    }
    /// That nothing of the first two lines has to give way, and nothing of what the room is.
    float wanted_width(const Pen& pen) const {
        return std::max({text_width(pen.fonts.title, patient), text_width(pen.fonts.strong, plan),
                         text_width(pen.fonts.strong, unreal)}) +
               1;
    }
    void draw(const Pen& pen, const Box& box) const {
        const float first = line_height(pen.fonts.title);
        const float second = plan.empty() ? 0 : line_height(pen.fonts.strong);
        const float last = rest.empty() && unreal.empty() ? 0 : line_height(pen.fonts.small);
        float y = box.y + std::max(0.0F, (box.height - first - second - last) / 2);
        pen.line(pen.fonts.title, shortened_in_the_middle(pen.fonts.title, patient, box.width), box.x, y + first / 2,
                 box.width, pen.theme->text);
        y += first;
        const ImFont* const font = has_room_for(pen.fonts.strong, plan, box.width) ? pen.fonts.strong : pen.fonts.small;
        pen.line(font, plan_in(font, plan, box.width), box.x, y + second / 2, box.width, pen.theme->text);
        y += second;
        float used = 0;
        if (!unreal.empty()) {
            pen.line(pen.fonts.strong, unreal, box.x, y + last / 2, box.width, pen.theme->amber);
            used = text_width(pen.fonts.strong, unreal) + 12 * pen.scale;
        }
        const std::string shown = parts_in(pen.fonts.small, rest, box.width - used);
        pen.line(pen.fonts.small, shown, box.x + used, y + last / 2, 0, pen.theme->quiet);
    }
};

/// Circle and margins of a step, beside its word.
float step_extra(const Pen& pen) {
    return std::ceil(60 * pen.scale);
}

float steps_width(const Pen& pen, float gap) {
    float width = 5 * gap;
    for (const char* step : kSteps) width += text_width(pen.fonts.strong, pen.say(step)) + step_extra(pen);
    return width;
}

void draw_steps(const Pen& pen, const Box& steps, const OperatorModel& model, float gap) {
    const float chip_height = std::min(steps.height, std::round(60 * pen.scale));
    const float spare = std::max(0.0F, (steps.width - steps_width(pen, gap)) / 6);
    const float more = std::min(spare, 20 * pen.scale);
    float x = steps.x + 3 * (spare - more);
    for (std::size_t i = 0; i < kSteps.size(); ++i) {
        const float width = text_width(pen.fonts.strong, pen.say(kSteps[i])) + step_extra(pen) + more;
        draw_step(pen, {x, steps.y + (steps.height - chip_height) / 2, width, chip_height}, i, model.steps[i]);
        x += width + gap;
    }
}

}  // namespace

void draw_header(const Pen& pen, const WindowLayout& place, const OperatorModel& model) {
    const float gap = 8 * pen.scale;
    const CaseLines lines(pen, model);
    Box title = place.title, steps = place.steps;
    const float side = side_width(pen, model.case_side);
    if (steps.y < title.bottom()) {  // beside each other: what the steps do not need is the case's, where it needs it
        const float wanted = lines.wanted_width(pen) + side - title.width;
        const float more = std::clamp(wanted, 0.0F, std::max(0.0F, steps.width - steps_width(pen, gap)));
        title.width += more, steps.x += more, steps.width -= more;
    }
    draw_side(pen, title, model.case_side);
    title.width -= side;
    lines.draw(pen, title);
    draw_steps(pen, steps, model, gap);
}

}  // namespace planlight
