#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/windows/number_text.h"
#include "app/windows/operator_keys.h"
#include "app/windows/panels.h"

namespace planlight {
namespace {

constexpr float kDepthWidth = 0.75F, kRiskWidth = 0.85F;  // of the other columns

struct Columns {
    float name_x, name_width, depth_x, risk_x, predicted_x, light_x, width;
    bool risk;  ///< the plan holds risk structures
};

Columns columns_of(const Pen& pen, const Box& box, bool risk) {
    const float pad = 18 * pen.scale, width = std::round((risk ? 0.18F : 0.20F) * box.width), name_x = box.x + pad;
    const float light_x = box.right() - pad - width, predicted_x = light_x - width,
                risk_x = predicted_x - (risk ? kRiskWidth * width : 0), depth_x = risk_x - kDepthWidth * width;
    return {name_x, depth_x - name_x - 4 * pen.scale, depth_x, risk_x, predicted_x, light_x, width, risk};
}

void draw_heading(const Pen& pen, const Columns& c, float top) {
    const float height = line_height(pen.fonts.small);
    const auto right = [&](const char* text, float x, float width, float row) {
        pen.line(pen.fonts.small, pen.say(text), x, top + height * (row + 0.5F), width, pen.theme->quiet,
                 Pen::Side::right);
    };
    pen.line(pen.fonts.small, pen.say("Plan item"), c.name_x, top + height, c.name_width, pen.theme->quiet);
    right("depth", c.depth_x, kDepthWidth * c.width, 0);
    right("mm", c.depth_x, kDepthWidth * c.width, 1);
    if (c.risk) {
        right("to risk", c.risk_x, kRiskWidth * c.width, 0);
        right("mm", c.risk_x, kRiskWidth * c.width, 1);
    }
    right("predicted", c.predicted_x, c.width, 0);
    right("95 % mm", c.predicted_x, c.width, 1);
    right("light seen", c.light_x, c.width, 0);
    right("off by mm", c.light_x, c.width, 1);
}

/// An error value; beyond its limits it has a shape beside it, not only a colour.
void draw_error(const Pen& pen, const OperatorModel& model, const std::optional<double>& value, float x, float width,
                float y) {
    const std::string text = number_text(value, "");
    const bool known = value && std::isfinite(*value);
    const bool stop = known && std::abs(*value) > model.stop_above_mm,
               warn = known && std::abs(*value) > model.warn_above_mm;
    const ImU32 colour = !known ? pen.theme->quiet : stop ? pen.theme->red : warn ? pen.theme->amber : pen.theme->green;
    pen.line(pen.fonts.body, text, x, y, width, colour, Pen::Side::right);
    const float radius = 8 * pen.scale;
    const ImVec2 mark(x + width - text_width(pen.fonts.body, text) - 2.2F * radius, y);
    if (stop)
        pen.polygon(mark, radius * 1.1F, 8, 0.3927F, pen.theme->red);
    else if (warn)
        pen.triangle(mark, radius, pen.theme->amber);
}

/// The distance to the nearest risk structure, as the light has it; 0 with the sign of a stop where it goes through.
void draw_risk(const Pen& pen, const Clearance& risk, float x, float width, float y) {
    const std::string text = risk.through ? pen.say("through") : fmt::format("{:.1f}", said_mm(risk));
    const float radius = 8 * pen.scale;
    const ImVec2 mark(x + width - text_width(pen.fonts.body, text) - 2.2F * radius, y);
    const bool warning = warns(risk);
    pen.line(pen.fonts.body, text, x, y, width,
             risk.through ? pen.theme->red
             : warning    ? pen.theme->amber
                          : pen.theme->text,
             Pen::Side::right);
    if (risk.through)
        pen.polygon(mark, radius * 1.1F, 8, 0.3927F, pen.theme->red);
    else if (warning)
        pen.triangle(mark, radius, pen.theme->amber);
}

/// `dim`: another item is that of the moment.
void draw_row(const Pen& pen, const OperatorModel& model, const PlanRow& row, const Columns& c, float y, bool dim) {
    const float size = 7 * pen.scale, swatch = 22 * pen.scale;
    if (row.hidden)
        pen.list->AddRect({c.name_x, y - size}, {c.name_x + 2 * size, y + size}, colour_of(row.colour), 3 * pen.scale,
                          0, 2 * pen.scale);
    else
        pen.swatch({c.name_x, y - size, 2 * size, 2 * size}, row.colour);
    pen.line(pen.fonts.body, shortened_in_the_middle(pen.fonts.body, row.name, c.name_width - swatch),
             c.name_x + swatch, y, c.name_width - swatch, dim || row.hidden ? pen.theme->quiet : pen.theme->text);
    pen.line(pen.fonts.body, number_text(row.depth_mm, ""), c.depth_x, y, kDepthWidth * c.width, pen.theme->text,
             Pen::Side::right);
    if (row.risk) draw_risk(pen, *row.risk, c.risk_x, kRiskWidth * c.width, y);
    draw_error(pen, model, row.predicted_error_mm, c.predicted_x, c.width, y);
    if (row.hidden)
        pen.line(pen.fonts.small, pen.say("hidden"), c.light_x, y, c.width, pen.theme->quiet, Pen::Side::right);
    else
        draw_error(pen, model, row.light_off_mm, c.light_x, c.width, y);
}

float evidence_height(const Pen& pen, const OperatorModel& model, float width) {
    std::size_t lines = 0;
    for (const std::string& sentence : model.evidence)
        lines += broken(pen.fonts.small, pen.say(sentence), width, 9).size();
    return line_height(pen.fonts.small) * static_cast<float>(lines);
}

void draw_evidence(const Pen& pen, const OperatorModel& model, Box box) {
    const float end = box.bottom() + 1;
    for (const std::string& sentence : model.evidence) {
        box.height = end - box.y;
        box.y += pen.paragraph(pen.fonts.small, pen.say(sentence), box, pen.theme->quiet);
    }
}

}  // namespace

int draw_table(const Pen& pen, const Box& box, const OperatorModel& model, int first_row, bool hovered,
               std::optional<std::size_t> marked) {
    pen.panel(box, pen.theme->panel, hovered ? pen.theme->quiet : pen.theme->edge);
    const float pad = 14 * pen.scale, line = line_height(pen.fonts.small);
    const Columns columns = columns_of(
        pen, box,
        std::any_of(model.rows.begin(), model.rows.end(), [](const PlanRow& row) { return row.risk.has_value(); }));
    draw_heading(pen, columns, box.y + pad / 2);
    const float rule = box.y + pad / 2 + 2 * line + 4 * pen.scale;
    pen.list->AddLine({box.x + pad, rule}, {box.right() - pad, rule}, pen.theme->edge, 1);

    const float row_height = std::round(line_height(pen.fonts.body) + 4 * pen.scale);
    const float text_width_px = box.width - 36 * pen.scale;
    const int count = static_cast<int>(model.rows.size());
    const float both = box.bottom() - pad - line - rule - pad, wanted = evidence_height(pen, model, text_width_px);
    const float left_over = std::max(both - static_cast<float>(count) * row_height, std::min(3 * line, 0.4F * both));
    const float evidence = std::min(wanted, std::floor(left_over / line) * line);
    const float room = both - evidence;
    int rows = std::max(1, static_cast<int>(room / row_height));
    if (rows < count) rows = std::max(1, static_cast<int>((room - line) / row_height));
    const int shown = std::min(rows, count - first_row);
    float y = rule + 4 * pen.scale;
    for (int i = 0; i < shown; ++i, y += row_height) {
        if (marked && static_cast<int>(*marked) == first_row + i)
            pen.list->AddRect({box.x + pad / 2, y}, {box.right() - pad / 2, y + row_height}, pen.theme->blue,
                              4 * pen.scale, 0, 2 * pen.scale);
        draw_row(pen, model, model.rows[static_cast<std::size_t>(first_row + i)], columns,
                 std::round(y + row_height / 2),
                 model.item_of_moment && static_cast<int>(*model.item_of_moment) != first_row + i);
    }
    if (rows < count)
        pen.line(pen.fonts.small,
                 pen.say("rows " + std::to_string(first_row + 1) + "–" + std::to_string(first_row + shown) + " of " +
                         std::to_string(count)),
                 columns.name_x, y + line / 2, text_width_px, pen.theme->amber);

    const float foot = box.bottom() - pad - line;
    draw_evidence(pen, model, {columns.name_x, foot - evidence, text_width_px, evidence});
    if (model.rows.empty() && model.evidence.empty()) return rows;
    const std::string all = evidence < wanted || rows < count ? "Press here for all of it" : "Press here for the page";
    pen.line(pen.fonts.small, pen.say(all) + " (" + key_text(KeyMeaning::evidence) + ")", columns.name_x,
             foot + line / 2, text_width_px, evidence < wanted || rows < count ? pen.theme->amber : pen.theme->quiet);
    return rows;
}

}  // namespace planlight
