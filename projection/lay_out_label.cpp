#include "projection/lay_out_label.h"

#include <algorithm>
#include <cmath>

#include "projection/stroke_font.h"

namespace planlight {
namespace {

constexpr double kLineSpacing = 1.65, kGap = 0.9;  // of a capital's height

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

class Block {
public:
    Block(double height_mm, const Lettering& letters) : height_mm_(height_mm), letters_(letters) {}

    void add_line(const std::string& text) {
        TextOutline outline = letters_.outline(text);
        block_.words += (block_.words.empty() ? "" : "\n") + text;
        const double half = outline.width / 2;
        rows_.push_back({{std::move(outline), -half}});
    }
    /// Beside the last line where there is room.
    bool join_line(const std::string& text) {
        TextOutline outline = letters_.outline(text);
        std::vector<Piece>& row = rows_.back();
        const double all = row.back().text.width + kGap + outline.width;
        if (row.size() != 1 || all * height_mm_ > 0.75 * kMaxLine_mm) return false;
        block_.words += "  " + text;
        const double second_begins = -all / 2 + row.back().text.width + kGap;
        row.back().begins = -all / 2;
        row.push_back({std::move(outline), second_begins});
        return true;
    }
    /// Lines so far apart that the ink of none touches another's.
    TextBlock block() {
        double y = 0, top = 0, bottom = 0, width = 0, low_before = 0;
        for (std::size_t r = 0; r < rows_.size(); ++r) {
            double low = 0, high = 1;
            for (const Piece& piece : rows_[r])
                low = std::min(low, piece.text.low), high = std::max(high, piece.text.high);
            if (r > 0) y -= std::max(kLineSpacing, high - low_before + 0.3);
            if (r == 0) top = high;
            bottom = y + low;
            low_before = low;
            for (Piece& piece : rows_[r]) {
                width = std::max(width, 2 * std::abs(piece.begins));
                block_.lines.push_back({std::move(piece.text), {height_mm_ * piece.begins, height_mm_ * y}});
            }
        }
        block_.width_mm = height_mm_ * width;
        block_.height_mm = height_mm_ * (top - bottom);
        for (auto& line : block_.lines) line.begins_mm.y() -= height_mm_ * (top + bottom) / 2;
        return std::move(block_);
    }

private:
    struct Piece {
        TextOutline text;
        double begins;  ///< of a capital's height, from the middle
    };
    double height_mm_;
    const Lettering& letters_;
    std::vector<std::vector<Piece>> rows_;
    TextBlock block_;
};

}  // namespace

std::string shortened(const std::string& name, double text_height_mm, const Lettering& letters) {
    return in_two_lines(name, text_height_mm, letters).empty() ? cut_in_the_middle(name, text_height_mm, letters)
                                                               : name;
}

TextBlock lay_out(const LabelText& text, double text_height_mm, const Lettering& letters) {
    const std::string name = shortened(text.name, text_height_mm, letters);
    Block block(text_height_mm, letters);
    if (!letters.outline(name).lacks.empty()) return {};
    bool may_join = !name.empty();
    if (!name.empty()) {
        const auto lines = in_two_lines(name, text_height_mm, letters);
        may_join = lines.size() == 1;
        for (const std::string& line : lines) block.add_line(line);
    }
    for (const std::string& figure : text.figures) {
        if (!letters.outline(figure).lacks.empty()) return {};
        if (!may_join || !block.join_line(figure)) block.add_line(figure);
        may_join = false;
    }
    return block.block();
}

}  // namespace planlight
