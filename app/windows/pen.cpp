#include "app/windows/pen.h"

#include <imgui_internal.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <numbers>

#include "projection/visual_order.h"

namespace planlight {
namespace {

const std::string kMore = "…";

/// Without its last character (UTF-8).
void drop_last(std::string& text) {
    while (!text.empty() && (static_cast<unsigned char>(text.back()) & 0xC0U) == 0x80U) text.pop_back();
    if (!text.empty()) text.pop_back();
}

std::string shortened(const ImFont* font, std::string text, float width) {
    if (text_width(font, text) <= width) return text;
    while (!text.empty() && text_width(font, text + kMore) > width) drop_last(text);
    return text + kMore;
}

/// What a line may begin with: a word, or a sign of a script without spaces.
struct Word {
    std::string text;
    bool spaced = true;  ///< a space stands before it
};

/// Chinese, Japanese, and the like: lines break between any two signs, but not before their punctuation.
bool breaks_anywhere(unsigned code) {
    const bool closes = code == 0x3001 || code == 0x3002 || code == 0xFF0C || code == 0xFF1A || code == 0xFF1B ||
                        code == 0xFF09 || code == 0xFF1F || code == 0x300D || code == 0x300F;
    return code >= 0x2E80 && code < 0xFFF0 && !closes && !(code >= 0xAC00 && code <= 0xD7AF);
}

/// "0.3 mm" and "95 %" are read as one: nothing breaks between them.
bool stays_with_number(const std::string& before, const char* next) {
    if (before.empty() || std::isdigit(static_cast<unsigned char>(before.back())) == 0) return false;
    const std::string word(next, std::strcspn(next, " \n\t"));
    for (const char* unit : {"%", "mm", "ms", "°", "px", "s", "Hz"})
        if (word.starts_with(unit) && word.find_first_not_of(".,:;)", std::strlen(unit)) == std::string::npos)
            return true;
    return word.starts_with("мм") || word.starts_with("мс");
}

std::vector<Word> words_in(const std::string& text) {
    std::vector<Word> words;
    bool spaced = true, begun = false;
    for (const char* at = text.c_str(); *at != '\0';) {
        unsigned code = 0;
        const int bytes = std::max(1, ImTextCharFromUtf8(&code, at, nullptr));
        if (code == ' ' || code == '\n' || code == '\t') {
            spaced = true;
            begun = false;
        } else {
            const bool unit = !begun && !words.empty() && stays_with_number(words.back().text, at);
            if (unit)
                words.back().text += ' ';
            else if (!begun || breaks_anywhere(code))
                words.push_back({"", spaced});
            words.back().text.append(at, static_cast<std::size_t>(bytes));
            spaced = false;
            begun = true;
        }
        at += bytes;
    }
    return words;
}

void note_lacking(const ImFont* font, const std::string& text, std::set<unsigned>& lacking) {
    for (const char* at = text.c_str(); *at != '\0';) {
        unsigned code = 0;
        at += std::max(1, ImTextCharFromUtf8(&code, at, nullptr));
        if (code >= 0x80 && code <= 0xFFFF && font->FindGlyphNoFallback(static_cast<ImWchar>(code)) == nullptr)
            lacking.insert(code);
    }
}

}  // namespace

float text_width(const ImFont* font, const std::string& line) {
    const std::string text = visual_order(line);
    return font->CalcTextSizeA(font->FontSize, 1e9F, 0, text.c_str(), text.c_str() + text.size()).x;
}

std::string shortened_in_the_middle(const ImFont* font, const std::string& text, float width) {
    if (text_width(font, text) <= width) return text;
    std::vector<std::string> signs;
    for (const char c : text) {
        if ((static_cast<unsigned char>(c) & 0xC0U) != 0x80U) signs.emplace_back();
        if (!signs.empty()) signs.back() += c;
    }
    std::string head, tail;
    std::size_t from = 0, to = signs.size();
    for (bool front = true; from < to; front = !front) {
        const std::string longer = front ? head + signs[from] + kMore + tail : head + kMore + signs[to - 1] + tail;
        if (text_width(font, longer) > width) break;
        if (front)
            head += signs[from++];
        else
            tail = signs[--to] + tail;
    }
    return head + kMore + tail;
}

float line_height(const ImFont* font) {
    return std::round(font->FontSize * 1.12F);
}

ImU32 colour_of(const Rgb& colour) {
    return IM_COL32(colour[0], colour[1], colour[2], 255);
}

std::vector<std::string> broken(const ImFont* font, const std::string& text, float width, std::size_t most) {
    std::vector<std::string> lines;
    std::string line;
    const std::vector<Word> words = words_in(text);
    for (std::size_t i = 0; i < words.size(); ++i) {
        const std::string longer = line.empty() ? words[i].text : line + (words[i].spaced ? " " : "") + words[i].text;
        if (line.empty() || text_width(font, longer) <= width) {
            line = longer;
            continue;
        }
        if (lines.size() + 1 == most) {
            line = longer;  // too long with all that follows, and so marked
            while (++i < words.size()) line += (words[i].spaced ? " " : "") + words[i].text;
            break;
        }
        lines.push_back(shortened(font, line, width));
        line = words[i].text;
    }
    if (!line.empty() && lines.size() < most) lines.push_back(shortened(font, line, width));
    return lines;
}

void Pen::panel(const Box& box, ImU32 fill, ImU32 edge, float edge_width) const {
    const ImVec2 low(box.x, box.y), high(box.right(), box.bottom());
    list->AddRectFilled(low, high, fill, 12 * scale);
    if (edge_width > 0) list->AddRect(low, high, edge, 12 * scale, 0, edge_width);
}

void Pen::line(const ImFont* font, const std::string& text, float x, float middle_y, float width, ImU32 colour,
               Side side) const {
    const std::string whole = width > 0 ? shortened(font, text, width) : text;
    if (cut && whole != text) cut->push_back(text);
    const std::string shown = visual_order(whole);
    if (lacking) note_lacking(font, shown, *lacking);
    const float spare = (width > 0 ? width : 0) - text_width(font, whole);
    if (side == Side::right) x += spare;
    if (side == Side::centre) x += spare / 2;
    list->AddText(font, font->FontSize, ImVec2(std::round(x), std::round(middle_y - font->FontSize / 2)), colour,
                  shown.c_str());
}

float Pen::paragraph(const ImFont* font, const std::string& text, const Box& box, ImU32 colour, Side side) const {
    const float height = line_height(font);
    const auto most = static_cast<std::size_t>(std::max(0.0F, std::floor(box.height / height)));
    const std::vector<std::string> parts = broken(font, text, box.width, most);
    const auto ends_early = [&](const std::string& part) { return part.ends_with(kMore) && !text.ends_with(kMore); };
    if (cut && !text.empty() && (most == 0 || std::any_of(parts.begin(), parts.end(), ends_early)))
        cut->push_back(text);
    if (most == 0) return 0;
    float y = box.y;
    for (const std::string& part : parts) {
        line(font, part, box.x, y + height / 2, box.width, colour, side);
        y += height;
    }
    return y - box.y;
}

void Pen::swatch(const Box& box, const Rgb& colour) const {
    list->AddRectFilled({box.x, box.y}, {box.right(), box.bottom()}, colour_of(colour), 3 * scale);
    list->AddRect({box.x, box.y}, {box.right(), box.bottom()}, theme->swatch_edge, 3 * scale, 0, 1.5F * scale);
}

void Pen::tick(ImVec2 middle, float size, ImU32 colour) const {
    const ImVec2 points[3] = {{middle.x - 0.5F * size, middle.y + 0.02F * size},
                              {middle.x - 0.12F * size, middle.y + 0.4F * size},
                              {middle.x + 0.55F * size, middle.y - 0.4F * size}};
    list->AddPolyline(points, 3, colour, 0, std::max(2.0F, 0.22F * size));
}

void Pen::triangle(ImVec2 middle, float radius, ImU32 colour) const {
    list->AddTriangleFilled({middle.x, middle.y - radius}, {middle.x + radius, middle.y + 0.8F * radius},
                            {middle.x - radius, middle.y + 0.8F * radius}, colour);
}

void Pen::polygon(ImVec2 middle, float radius, int corners, float turn, ImU32 colour) const {
    std::vector<ImVec2> points;
    for (int i = 0; i < corners; ++i) {
        const float angle = turn + 2 * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(corners);
        points.emplace_back(middle.x + radius * std::cos(angle), middle.y + radius * std::sin(angle));
    }
    list->AddConvexPolyFilled(points.data(), corners, colour);
}

}  // namespace planlight
