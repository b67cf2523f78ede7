#include "app/report/pdf_letters.h"

#include <algorithm>
#include <array>
#include <utility>

#include "projection/stroke_font.h"

namespace planlight {
namespace {

bool within(char32_t code, std::initializer_list<std::pair<char32_t, char32_t>> ranges) {
    return std::any_of(ranges.begin(), ranges.end(),
                       [&](const auto& range) { return code >= range.first && code <= range.second; });
}

/// DejaVu Sans has it, one sign a letter, from left to right.
bool is_plain(char32_t code) {
    return within(code, {{0, 0x2FF},
                         {0x370, 0x52F},
                         {0x1E00, 0x1FFF},
                         {0x2000, 0x2027},
                         {0x202F, 0x2061},
                         {0x2070, 0x23CF},
                         {0x25A0, 0x25FF},
                         {0x26A0, 0x26A0},
                         {0x2713, 0x2717}});
}

/// Hebrew, Arabic and their neighbours, and their forms for old programs.
bool reads_leftwards(char32_t code) {
    return within(code, {{0x590, 0x8FF}, {0xFB1D, 0xFDFF}, {0xFE70, 0xFEFF}, {0x10800, 0x10FFF}, {0x1E800, 0x1EFFF}});
}

bool all_plain(const std::string& text) {
    const std::u32string codes = code_points(text);
    return std::all_of(codes.begin(), codes.end(), is_plain);
}

PdfLetters piece_of(const std::string& text) {
    if (all_plain(text)) return {text, std::nullopt};
    TextOutline outline = lettering().outline(text);
    if (!outline.lacks.empty()) return {text, std::nullopt};
    return {text, std::move(outline)};
}

}  // namespace

std::vector<PdfLetters> letters_of(const std::string& line) {
    if (all_plain(line)) return {{line, std::nullopt}};
    const std::u32string codes = code_points(line);
    if (std::any_of(codes.begin(), codes.end(), reads_leftwards)) return {piece_of(line)};
    std::vector<PdfLetters> pieces;
    for (std::size_t at = 0; at < line.size();) {
        const std::size_t end = std::min(line.find(' ', at), line.size() - 1) + 1;
        PdfLetters next = piece_of(line.substr(at, end - at));
        if (!pieces.empty() && !next.outline && !pieces.back().outline)
            pieces.back().text += next.text;
        else
            pieces.push_back(std::move(next));
        at = end;
    }
    return pieces;
}

}  // namespace planlight
