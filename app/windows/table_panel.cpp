#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "app/windows/number_text.h"
#include "app/windows/operator_keys.h"
#include "app/windows/panels.h"

namespace planlight {
namespace {

/// Two lines of a heading.
using Heading = std::array<const char*, 2>;
constexpr Heading kDepth{"depth", "mm"}, kPredicted{"predicted", "95 % mm"}, kLight{"light seen", "off by mm"};

/// Figures, right-aligned.
struct Column {
    float x = 0, width = 0;
};
/// As wide as what stands in them, and apart from each other; the names have the rest.
struct Columns {
    float name_x, name_width;
    Column depth, predicted, light;
};

float mark_radius(const Pen& pen) {
    return 8 * pen.scale;
}

/// Of a figure with the shape of a warning beside it.
float figure_width(const Pen& pen, const std::string& text) {
    return text_width(pen.fonts.body, text) + 3.3F * mark_radius(pen);
}

float heading_width(const Pen& pen, const Heading& heading) {
    return std::max(text_width(pen.fonts.small, pen.say(heading[0])), text_width(pen.fonts.small, pen.say(heading[1])));
}

Columns columns_of(const Pen& pen, const Box& box, const OperatorModel& model) {
    const float pad = 18 * pen.scale, gap = 20 * pen.scale;
    Columns c{box.x + pad, 0, {}, {}, {}};
    const float usual = figure_width(pen, "88.8");  // so that they do not jump while they change
    c.depth.width = std::max(heading_width(pen, kDepth), text_width(pen.fonts.body, "88.8"));
    c.predicted.width = std::max(heading_width(pen, kPredicted), usual);
    c.light.width = std::max(heading_width(pen, kLight), usual);
    for (const PlanRow& row : model.rows) {
        c.depth.width = std::max(c.depth.width, text_width(pen.fonts.body, number_text(row.depth_mm, "")));
        c.predicted.width = std::max(c.predicted.width, figure_width(pen, number_text(row.predicted_error_mm, "")));
        c.light.width = std::max(c.light.width, row.hidden ? text_width(pen.fonts.small, pen.say("hidden"))
                                                           : figure_width(pen, number_text(row.light_off_mm, "")));
    }
    float right = box.right() - pad;
    for (Column* column : {&c.light, &c.predicted, &c.depth}) {
        column->width = std::ceil(column->width);
        column->x = std::floor(right - column->width);
        right = column->x - gap;
    }
    c.name_width = right - c.name_x;
    return c;
}

void draw_heading(const Pen& pen, const Columns& c, float top) {
    const float height = line_height(pen.fonts.small);
    pen.line(pen.fonts.small, pen.say("Plan item"), c.name_x, top + height, c.name_width, pen.theme->quiet);
    for (const auto& [heading, column] : {std::pair{kDepth, c.depth}, {kPredicted, c.predicted}, {kLight, c.light}})
        for (const std::size_t row : {0U, 1U})
            pen.line(pen.fonts.small, pen.say(heading[row]), column.x, top + height * (static_cast<float>(row) + 0.5F),
                     column.width, pen.theme->quiet, Pen::Side::right);
}

/// An error value; beyond its limits it has a shape beside it, not only a colour.
void draw_error(const Pen& pen, const OperatorModel& model, const std::optional<double>& value, const Column& column,
                float y) {
    const std::string text = error_text(value, "", {model.warn_above_mm, model.stop_above_mm});
    const bool known = value && std::isfinite(*value);
    const bool stop = known && std::abs(*value) > model.stop_above_mm,
               warn = known && std::abs(*value) > model.warn_above_mm;
    const ImU32 colour = !known ? pen.theme->quiet : stop ? pen.theme->red : warn ? pen.theme->amber : pen.theme->green;
    pen.line(pen.fonts.body, text, column.x, y, column.width, colour, Pen::Side::right);
    const float radius = mark_radius(pen);
    const ImVec2 mark(column.x + column.width - text_width(pen.fonts.body, text) - 2.2F * radius, y);
    if (stop)
        pen.polygon(mark, radius * 1.1F, 8, 0.3927F, pen.theme->red);
    else if (warn)
        pen.triangle(mark, radius, pen.theme->amber);
}

/// "4.1 mm to Facial nerve", and how many others warn.
std::string risk_words(const PlanRow& row) {
    return clearance_in_words(row.risk.front()) +
           (row.risk.size() > 1 ? fmt::format(" and {} more", row.risk.size() - 1) : "");
}

/// Below the item's name: how near it comes to a risk structure. What warns has a shape before it.
void draw_risk(const Pen& pen, const PlanRow& row, float x, float width, float y) {
    const float radius = 0.85F * mark_radius(pen), indent = near_risk(row) ? 3 * radius : 0;
    const bool through = through_risk(row);
    if (through)
        pen.polygon({x + radius, y}, radius * 1.1F, 8, 0.3927F, pen.theme->red);
    else if (near_risk(row))
        pen.triangle({x + radius, y}, radius, pen.theme->amber);
    pen.line(pen.fonts.small, shortened_in_the_middle(pen.fonts.small, pen.say(risk_words(row)), width - indent),
             x + indent, y, width - indent,
             through          ? pen.theme->red
             : near_risk(row) ? pen.theme->amber
                              : pen.theme->quiet);
}

/// `dim`: another item is that of the moment.
void draw_row(const Pen& pen, const OperatorModel& model, const PlanRow& row, const Columns& c, float y, bool dim) {
    const float size = 7 * pen.scale, swatch = 22 * pen.scale;
    if (row.hidden)
        pen.list->AddRect({c.name_x, y - size}, {c.name_x + 2 * size, y + size}, colour_of(row.colour), 3 * pen.scale,
                          0, 2 * pen.scale);
    else
        pen.swatch({c.name_x, y - size, 2 * size, 2 * size}, row.colour);
    const std::string& name = row.short_name.empty() ? row.name : row.short_name;
    pen.line(pen.fonts.body, shortened_in_the_middle(pen.fonts.body, name, c.name_width - swatch), c.name_x + swatch, y,
             c.name_width - swatch, dim || row.hidden ? pen.theme->quiet : pen.theme->text);
    pen.line(pen.fonts.body, number_text(row.depth_mm, ""), c.depth.x, y, c.depth.width, pen.theme->text,
             Pen::Side::right);
    draw_error(pen, model, row.predicted_error_mm, c.predicted, y);
    if (row.hidden)
        pen.line(pen.fonts.small, pen.say("hidden"), c.light.x, y, c.light.width, pen.theme->quiet, Pen::Side::right);
    else
        draw_error(pen, model, row.light_off_mm, c.light, y);
}

/// How high every row is: of two lines where something is said of a risk structure. That which does not warn is said
/// only where `all` have room.
std::vector<float> row_heights(const Pen& pen, const OperatorModel& model, bool all) {
    std::vector<float> heights;
    for (const PlanRow& row : model.rows)
        heights.push_back(std::round(line_height(pen.fonts.body) + 4 * pen.scale) +
                          (near_risk(row) || (all && !row.risk.empty()) ? line_height(pen.fonts.small) : 0));
    return heights;
}

float sum_of(const std::vector<float>& heights) {
    return std::accumulate(heights.begin(), heights.end(), 0.0F);
}

/// How many rows there is room for, at least one.
int fitting(const std::vector<float>& heights, int first, float room) {
    int rows = 0;
    for (std::size_t i = static_cast<std::size_t>(first); i < heights.size() && heights[i] <= room; ++i, ++rows)
        room -= heights[i];
    return std::max(1, rows);
}

/// The wanted one, but that no room is left below the last, and that the row that is sought is seen.
int first_row_of(const std::vector<float>& heights, const TableView& view, float room) {
    const int count = static_cast<int>(heights.size());
    const auto reaches_end = [&](int first) { return first + fitting(heights, first, room) >= count; };
    int first = std::clamp(view.first_row, 0, std::max(0, count - 1));
    if (view.seek && view.marked && static_cast<int>(*view.marked) < count) {
        const int sought = static_cast<int>(*view.marked);
        first = std::min(first, sought);
        while (first < sought && first + fitting(heights, first, room) <= sought) ++first;
    }
    while (first > 0 && reaches_end(first - 1)) --first;
    return first;
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

float table_name_width(const Pen& pen, const Box& box, const OperatorModel& model) {
    return columns_of(pen, box, model).name_width - 22 * pen.scale;
}

int draw_table(const Pen& pen, const Box& box, const OperatorModel& model, const TableView& view, bool hovered) {
    pen.panel(box, pen.theme->panel, hovered ? pen.theme->quiet : pen.theme->edge);
    const float pad = 14 * pen.scale, line = line_height(pen.fonts.small);
    const Columns columns = columns_of(pen, box, model);
    draw_heading(pen, columns, box.y + pad / 2);
    const float rule = box.y + pad / 2 + 2 * line + 4 * pen.scale;
    pen.list->AddLine({box.x + pad, rule}, {box.right() - pad, rule}, pen.theme->edge, 1);

    const float text_width_px = box.width - 36 * pen.scale;
    const int count = static_cast<int>(model.rows.size());
    const float both = box.bottom() - pad - line - rule - pad, wanted = evidence_height(pen, model, text_width_px);
    const float some =
        std::min({wanted, 3 * line, 0.4F * both});  // of the evidence, where all rows have room beside it
    const bool all_risks = sum_of(row_heights(pen, model, true)) <= both - some;
    const std::vector<float> heights = row_heights(pen, model, all_risks);
    const float all = sum_of(heights), least = all <= both - some ? some : 0;
    const float evidence = std::min(wanted, std::floor(std::max(both - all, least) / line) * line);
    const float room = both - evidence, room_for_rows = all > room ? room - line : room;
    const int first_row = first_row_of(heights, view, room_for_rows),
              shown = std::min(fitting(heights, first_row, room_for_rows), count - first_row);
    float y = rule + 4 * pen.scale;
    for (int i = first_row; i < first_row + shown; ++i) {
        const PlanRow& row = model.rows[static_cast<std::size_t>(i)];
        const float height = heights[static_cast<std::size_t>(i)];
        const bool told = !row.risk.empty() && (all_risks || near_risk(row));
        if (view.marked && static_cast<int>(*view.marked) == i)
            pen.list->AddRect({box.x + pad / 2, y}, {box.right() - pad / 2, y + height}, pen.theme->blue, 4 * pen.scale,
                              0, 2 * pen.scale);
        draw_row(pen, model, row, columns, std::round(y + (told ? height - line : height) / 2),
                 model.item_of_moment && static_cast<int>(*model.item_of_moment) != i);
        if (told)
            draw_risk(pen, row, columns.name_x + 22 * pen.scale, text_width_px - 22 * pen.scale,
                      std::round(y + height - line / 2 - 2 * pen.scale));
        y += height;
    }
    if (shown < count)
        pen.line(pen.fonts.small,
                 pen.say("rows " + std::to_string(first_row + 1) + "–" + std::to_string(first_row + shown) + " of " +
                         std::to_string(count)),
                 columns.name_x, y + line / 2, text_width_px, pen.theme->amber);

    const float foot = box.bottom() - pad - line;
    draw_evidence(pen, model, {columns.name_x, foot - evidence, text_width_px, evidence});
    if (model.rows.empty() && model.evidence.empty()) return first_row;
    const std::string words =
        evidence < wanted || shown < count ? "Press here for all of it" : "Press here for the page";
    pen.line(pen.fonts.small, pen.say(words) + " (" + key_text(KeyMeaning::evidence) + ")", columns.name_x,
             foot + line / 2, text_width_px, evidence < wanted || shown < count ? pen.theme->amber : pen.theme->quiet);
    return first_row;
}

}  // namespace planlight
