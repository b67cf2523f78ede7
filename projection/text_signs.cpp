#include "projection/text_signs.h"

#include <hb.h>

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

bool is_digit(char32_t code) {
    return code >= U'0' && code <= U'9';
}

/// What may stand right before a figure and belongs to it.
bool is_sign_of_figure(char32_t code) {
    return std::u32string_view(U"+-−±<>≤≥≈~øØ⌀°").find(code) != std::u32string_view::npos;
}

/// A digit with which a figure begins: not within "B3", "12.5" or "2026-11-22".
bool begins_figure(const std::u32string& text, std::size_t at) {
    if (!is_digit(text[at])) return false;
    if (at == 0) return true;
    const char32_t before = text[at - 1];
    const bool letter = (before >= U'A' && before <= U'Z') || (before >= U'a' && before <= U'z');
    const bool within =
        at > 1 && is_digit(text[at - 2]) && std::u32string_view(U".,:/-").find(before) != std::u32string_view::npos;
    return !letter && !within && !is_digit(before);
}

}  // namespace

std::u32string mark_figures(const std::u32string& text) {
    constexpr char32_t kFromTheLeft = 0x200E;
    std::u32string marked;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (begins_figure(text, i)) {
            std::size_t at = marked.size();
            while (at > 0 && is_sign_of_figure(marked[at - 1])) --at;
            marked.insert(at, 1, kFromTheLeft);
        }
        marked += text[i];
    }
    return marked;
}

bool has_no_ink(char32_t code) {
    return code == 0x00AD || code == 0x034F || code == 0x061C || (code >= 0x200B && code <= 0x200F) ||
           (code >= 0x202A && code <= 0x202E) || (code >= 0x2060 && code <= 0x206F) || code == 0xFEFF ||
           (code >= 0xFE00 && code <= 0xFE0F) || (code >= 0xE0100 && code <= 0xE01EF);
}

bool is_control(char32_t code) {
    return code < 0x20 || (code >= 0x7F && code < 0xA0);
}

bool orders_direction(char32_t code) {
    return (code >= 0x202A && code <= 0x202E) || (code >= 0x2066 && code <= 0x2069);
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
