#include "projection/lay_out_label.h"

#include <algorithm>
#include <cmath>

#include "projection/stroke_font.h"
#include "projection/text_signs.h"

namespace planlight {
namespace {

constexpr double kLineSpacing = 1.65, kBetween = 0.3;  // of a capital's height

double width_mm(const std::string& text, double height_mm, const Lettering& letters) {
    return height_mm * letters.outline(text).width;
}

bool fits(const std::string& text, double height_mm, const Lettering& letters) {
    return width_mm(text, height_mm, letters) <= kMaxLine_mm;
}

std::string joined(const std::vector<std::string>& signs, std::size_t from, std::size_t to) {
    std::string text;
    for (std::size_t i = from; i < to; ++i) text += signs[i];
    return text;
}

/// May a line end between these two of the reader's signs?
bool may_part(const std::string& before, const std::string& after) {
    constexpr char32_t kFirstOfTheEast = 0x2E80;  // from here on writing without blanks: Chinese, Japanese, Korean
    if (before == " " || before == "-" || before == "/" || before == "_") return true;
    return code_points(before).front() >= kFirstOfTheEast && code_points(after).front() >= kFirstOfTheEast;
}

/// A name in one or two lines, parted where a reader expects it; empty when two are not enough.
std::vector<std::string> in_two_lines(const std::string& name, double height_mm, const Lettering& letters) {
    if (fits(name, height_mm, letters)) return {name};
    std::vector<std::string> best;
    double best_mm = kMaxLine_mm;
    const auto signs = readers_signs(name);
    for (std::size_t at = 1; at < signs.size(); ++at) {
        if (!may_part(signs[at - 1], signs[at])) continue;
        const std::string first = joined(signs, 0, signs[at - 1] == " " ? at - 1 : at),
                          second = joined(signs, at, signs.size());
        const double wider_mm = std::max(width_mm(first, height_mm, letters), width_mm(second, height_mm, letters));
        if (!first.empty() && wider_mm <= best_mm) best = {first, second}, best_mm = wider_mm;
    }
    return best;
}

/// As much of the name's two ends as one line holds.
std::string cut_in_the_middle(const std::string& name, double height_mm, const Lettering& letters) {
    const auto signs = readers_signs(name);
    for (std::size_t kept = signs.size() - 1; kept > 1; --kept) {
        const std::size_t first = (kept + 1) / 2;
        const std::string text =
            joined(signs, 0, first) + "…" + joined(signs, signs.size() - (kept - first), signs.size());
        if (fits(text, height_mm, letters)) return text;
    }
    return signs.empty() ? std::string() : signs.front() + "…";
}

void add_risk(const RiskText& risk, double height_mm, const Lettering& letters, std::vector<std::string>& lines) {
    if (const std::string whole = risk.figure + " " + risk.structure; !risk.apart && fits(whole, height_mm, letters)) {
        lines.push_back(whole);
    } else {
        lines.push_back(risk.figure);
        const auto name = in_two_lines(shortened(risk.structure, height_mm, letters), height_mm, letters);
        lines.insert(lines.end(), name.begin(), name.end());
    }
    if (!risk.more.empty()) lines.push_back(risk.more);
}

/// Lines below each other, so far apart that the ink of none touches another's; (0,0) in the middle of all.
TextBlock stacked(const std::vector<std::string>& texts, double height_mm, const Lettering& letters) {
    TextBlock block;
    double y = 0, top = 0, bottom = 0, low_before = 0;
    for (const std::string& text : texts) {
        TextOutline outline = letters.outline(text);
        const bool first = block.lines.empty();
        const double low = std::min(0.0, outline.low), high = std::max(1.0, outline.high);
        if (!first) y -= std::max(kLineSpacing, high - low_before + kBetween);
        if (first) top = high;
        bottom = y + low;
        low_before = low;
        block.width_mm = std::max(block.width_mm, height_mm * outline.width);
        block.words += (first ? "" : "\n") + text;
        const double begins_mm = -height_mm * outline.width / 2;
        block.lines.push_back({std::move(outline), {begins_mm, height_mm * y}});
    }
    block.height_mm = height_mm * (top - bottom);
    for (auto& line : block.lines) line.begins_mm.y() -= height_mm * (top + bottom) / 2;
    return block;
}

}  // namespace

std::string shortened(const std::string& name, double text_height_mm, const Lettering& letters) {
    return in_two_lines(name, text_height_mm, letters).empty() ? cut_in_the_middle(name, text_height_mm, letters)
                                                               : name;
}

TextBlock lay_out(const LabelText& text, double text_height_mm, const Lettering& letters) {
    std::vector<std::string> lines;
    if (!text.name.empty())
        lines = in_two_lines(shortened(text.name, text_height_mm, letters), text_height_mm, letters);
    lines.insert(lines.end(), text.figures.begin(), text.figures.end());
    if (text.risk) add_risk(*text.risk, text_height_mm, letters, lines);
    for (const std::string& line : lines)
        if (!letters.outline(line).lacks.empty()) return {};
    return stacked(lines, text_height_mm, letters);
}

}  // namespace planlight
