#include "projection/text_signs.h"

#include <hb.h>

#include <optional>
#include <string_view>

#include "projection/stroke_font.h"

namespace planlight {
namespace {

bool is_mark(char32_t code) {
    const auto category = hb_unicode_general_category(hb_unicode_funcs_get_default(), code);
    return category == HB_UNICODE_GENERAL_CATEGORY_NON_SPACING_MARK ||
           category == HB_UNICODE_GENERAL_CATEGORY_SPACING_MARK ||
           category == HB_UNICODE_GENERAL_CATEGORY_ENCLOSING_MARK;
}

bool is_one_of(std::u32string_view signs, char32_t code) {
    return signs.find(code) != std::u32string_view::npos;
}

/// Of Western, Arabic and Persian figures.
bool is_digit(char32_t code) {
    return (code >= U'0' && code <= U'9') || (code >= 0x660 && code <= 0x669) || (code >= 0x6F0 && code <= 0x6F9);
}

bool is_blank(char32_t code) {
    return is_one_of(U" \t\u00A0\u2009\u202F", code);
}

constexpr std::u32string_view kOpens = U"([{<\"'«“„‘";
constexpr std::u32string_view kDiameters = U"±≤≥≈~øØ⌀";  // before a figure, with or without a blank
constexpr std::u32string_view kSigns = U"+-−±<>≤≥≈~øØ⌀°";
constexpr std::u32string_view kUnits = U"%‰°′″";      // letters of a unit know their direction themselves
constexpr std::u32string_view kWithin = U".,:/-–−×";  // between two digits of a figure

/// Where the figure begins of which text[at] is the first digit, its sign included; empty where the digit belongs to a
/// word: "B3", "אב-12".
std::optional<std::size_t> figure_from(const std::u32string& text, std::size_t at) {
    std::size_t from = at;
    while (from > 0 && is_one_of(kSigns, text[from - 1])) --from;
    if (from > 1 && is_blank(text[from - 1]) && is_one_of(kDiameters, text[from - 2])) from -= 2;
    if (from > 0 && !is_blank(text[from - 1]) && !is_one_of(kOpens, text[from - 1])) return std::nullopt;
    return from;
}

/// Past its last digit, and past a unit that is no letter.
std::size_t figure_to(const std::u32string& text, std::size_t at) {
    const auto digit = [&](std::size_t i) { return i < text.size() && is_digit(text[i]); };
    while (digit(at) || (at < text.size() && is_one_of(kWithin, text[at]) && digit(at + 1))) ++at;
    if (at < text.size() && is_one_of(kUnits, text[at])) return at + 1;
    if (at + 1 < text.size() && is_blank(text[at]) && is_one_of(kUnits, text[at + 1])) return at + 2;
    return at;
}

}  // namespace

std::u32string mark_figures(const std::u32string& text) {
    constexpr char32_t kFromTheLeft = 0x200E;
    std::u32string marked;
    std::size_t done = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (!is_digit(text[i])) continue;
        const auto from = figure_from(text, i);
        const std::size_t to = figure_to(text, i);
        if (from) {
            marked.append(text, done, *from - done).push_back(kFromTheLeft);
            marked.append(text, *from, to - *from).push_back(kFromTheLeft);
            done = to;
        }
        i = to - 1;
    }
    return marked.append(text, done);
}

bool has_no_ink(char32_t code) {
    return code == 0x00AD || code == 0x034F || code == 0x061C || (code >= 0x200B && code <= 0x200F) ||
           (code >= 0x202A && code <= 0x202E) || (code >= 0x2060 && code <= 0x206F) || code == 0xFEFF ||
           (code >= 0xFE00 && code <= 0xFE0F) || (code >= 0xE0100 && code <= 0xE01EF);
}

bool is_control(char32_t code) {
    return code < 0x20 || (code >= 0x7F && code < 0xA0);
}

bool is_no_letter(char32_t code) {
    return code == 0xFFFD ||
           hb_unicode_general_category(hb_unicode_funcs_get_default(), code) == HB_UNICODE_GENERAL_CATEGORY_PRIVATE_USE;
}

std::vector<std::size_t> clusters_of(const std::u32string& text) {
    std::vector<std::size_t> begins;
    for (std::size_t i = 0; i < text.size(); ++i)
        if (i == 0 || (!is_mark(text[i]) && !has_no_ink(text[i]))) {
            const bool joined = i > 0 && text[i - 1] == 0x200D;  // a zero width joiner
            if (!joined) begins.push_back(i);
        }
    begins.push_back(text.size());
    return begins;
}

std::vector<std::string> readers_signs(const std::string& utf8) {
    const std::u32string text = code_points(utf8);
    const auto begins = clusters_of(text);
    std::vector<std::string> signs;
    for (std::size_t c = 0; c + 1 < begins.size(); ++c) {
        signs.emplace_back();
        for (std::size_t i = begins[c]; i < begins[c + 1]; ++i) signs.back() += utf8_of(text[i]);
    }
    return signs;
}

std::string utf8_of(char32_t code) {
    const auto byte = [](char32_t bits) { return static_cast<char>(static_cast<unsigned char>(bits)); };
    if (code < 0x80) return {byte(code)};
    if (code < 0x800) return {byte(0xC0 | (code >> 6)), byte(0x80 | (code & 0x3F))};
    if (code < 0x10000)
        return {byte(0xE0 | (code >> 12)), byte(0x80 | ((code >> 6) & 0x3F)), byte(0x80 | (code & 0x3F))};
    return {byte(0xF0 | (code >> 18)), byte(0x80 | ((code >> 12) & 0x3F)), byte(0x80 | ((code >> 6) & 0x3F)),
            byte(0x80 | (code & 0x3F))};
}

}  // namespace planlight
