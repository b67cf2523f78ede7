// The lines of the page: those that want a person, and those that are good.
#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "app/windows/doctor_page_panels.h"
#include "app/windows/panels.h"
#include "app/windows/status_shape.h"

namespace planlight {
namespace {

using Line = DoctorPageModel::Line;
using Health = DoctorPageModel::Health;

/// A line as it will be drawn: its height, and how it is drawn from there on.
struct Row {
    float height = 0;
    std::function<void(float y)> draw;
};

float text_height(const ImFont* font, const std::string& text, float width) {
    constexpr std::size_t kAnyLines = 99;
    return text.empty() ? 0 : line_height(font) * static_cast<float>(broken(font, text, width, kAnyLines).size());
}

/// How many rows must be left out above so that the last one is seen.
int most_left_out(const std::vector<Row>& rows, float room) {
    float used = 0;
    auto first = static_cast<int>(rows.size());
    while (first > 0 && used + rows[static_cast<std::size_t>(first - 1)].height <= room)
        used += rows[static_cast<std::size_t>(--first)].height;
    return std::min(first, std::max(0, static_cast<int>(rows.size()) - 1));
}

/// Rows below a heading; how many more there are above and below stands in the heading's row and at the foot.
void draw_rows(const Pen& pen, const Box& box, const std::string& heading, const std::vector<Row>& rows, int& scroll) {
    pen.panel(box);
    const float s = pen.scale, pad = 18 * s, head = line_height(pen.fonts.title) + 10 * s,
                foot = line_height(pen.fonts.small) + 4 * s, top = box.y + 8 * s + head,
                room = box.bottom() - foot - top;
    scroll = std::clamp(scroll, 0, most_left_out(rows, room));
    pen.line(pen.fonts.title, heading, box.x + pad, box.y + 8 * s + head / 2, 0.7F * box.width, pen.theme->text);
    float y = top;
    auto next = static_cast<std::size_t>(scroll);
    for (; next < rows.size() && (y == top || y + rows[next].height <= top + room); ++next) {
        rows[next].draw(y);
        y += rows[next].height;
    }
    const auto more = [&](const char* arrow, std::size_t count, float middle_y) {
        if (count == 0) return;
        pen.line(pen.fonts.small, fmt::format("{} {}", arrow, pen.say(fmt::format("{} more", count))), box.x + pad,
                 middle_y, box.width - 2 * pad, pen.theme->blue, Pen::Side::right);
    };
    more("↑", static_cast<std::size_t>(scroll), box.y + 8 * s + head / 2);
    more("↓", rows.size() - next, box.bottom() - foot / 2);
}

/// Word, subject, what was found, and what to do.
Row wanted_row(const Pen& pen, const Box& box, const Line& line) {
    const float s = pen.scale, pad = 18 * s, mark = 0.42F * line_height(pen.fonts.title), x = box.x + pad,
                text_x = x + 2 * mark + 14 * s, width = box.right() - pad - text_x;
    const std::string word = pen.say(
        doctor_word(line.health == Health::stop ? DoctorPageModel::Verdict::stop : DoctorPageModel::Verdict::look));
    const std::string subject = pen.say(line.subject), said = pen.say(line.said),
                      remedy = line.remedy.empty() ? "" : "→ " + pen.say(line.remedy);
    const float head = line_height(pen.fonts.title);
    Row row;
    row.height = head + text_height(pen.fonts.body, said, width) + text_height(pen.fonts.body, remedy, width) + 18 * s;
    row.draw = [=, stop = line.health == Health::stop, &pen](float y) {
        const StatusKind kind = stop ? StatusKind::refused : StatusKind::check;
        const ImU32 colour = stop ? pen.theme->red : pen.theme->amber;
        const BannerLook look{pen.theme->panel, colour, colour, colour, colour};
        draw_status_shape(pen, kind, {x + mark, y + head / 2}, mark, look);
        pen.line(pen.fonts.title, word, text_x, y + head / 2, width, colour);
        const float word_width = text_width(pen.fonts.title, word) + 16 * s;
        pen.line(pen.fonts.title, subject, text_x + word_width, y + head / 2, width - word_width, pen.theme->text);
        float at = y + head;
        at += pen.paragraph(pen.fonts.body, said, {text_x, at, width, y + row.height - at}, pen.theme->text);
        pen.paragraph(pen.fonts.body, remedy, {text_x, at, width, y + row.height - at}, pen.theme->quiet);
    };
    return row;
}

/// The subject beside what was found.
Row good_row(const Pen& pen, const Box& box, const Line& line, float subjects) {
    const float s = pen.scale, pad = 18 * s, mark = 0.4F * line_height(pen.fonts.small), x = box.x + pad,
                subject_x = x + 2 * mark + 12 * s, said_x = subject_x + subjects + 16 * s,
                width = box.right() - pad - said_x;
    const std::string subject = pen.say(line.subject), said = pen.say(line.said);
    Row row;
    const float head = line_height(pen.fonts.small);
    row.height = std::max(head, text_height(pen.fonts.small, said, width)) + 3 * s;
    row.draw = [=, &pen](float y) {
        pen.tick({x + mark, y + head / 2}, 2 * mark, pen.theme->green);
        pen.line(pen.fonts.small, subject, subject_x, y + head / 2, subjects + 1, pen.theme->quiet);
        pen.paragraph(pen.fonts.small, said, {said_x, y, width, row.height}, pen.theme->text);
    };
    return row;
}

}  // namespace

void draw_wanted_lines(const Pen& pen, const Box& box, const DoctorPageModel& model, int& scroll) {
    std::vector<Row> rows;
    for (const Health health : {Health::stop, Health::look})
        for (const Line& line : model.lines)
            if (line.health == health) rows.push_back(wanted_row(pen, box, line));
    draw_rows(pen, box, pen.say(rows.empty() ? "Nothing is to be done" : fmt::format("To be done: {}", rows.size())),
              rows, scroll);
}

void draw_good_lines(const Pen& pen, const Box& box, const DoctorPageModel& model, int& scroll) {
    float subjects = 0;
    for (const Line& line : model.lines)
        if (line.health == Health::good)
            subjects = std::max(subjects, text_width(pen.fonts.small, pen.say(line.subject)));
    std::vector<Row> rows;
    for (const Line& line : model.lines)
        if (line.health == Health::good)
            rows.push_back(good_row(pen, box, line, std::min(subjects, 0.45F * box.width)));
    draw_rows(pen, box, pen.say(fmt::format("Good: {}", rows.size())), rows, scroll);
}

}  // namespace planlight
