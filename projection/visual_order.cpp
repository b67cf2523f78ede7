#include "projection/visual_order.h"

#include <fribidi/fribidi.h>

#include <algorithm>

#include "planning_io/types/reading_direction.h"
#include "projection/stroke_font.h"
#include "projection/text_signs.h"

namespace planlight {
namespace {

/// Letters from U+0590 on begin with such a byte, and so do the orders: most lines have none, and are told at once.
bool may_read_leftwards(const std::string& line) {
    return std::any_of(line.begin(), line.end(), [](char c) { return static_cast<unsigned char>(c) >= 0xD6U; });
}

const FriBidiChar* codes_of(const std::u32string& text) {
    return reinterpret_cast<const FriBidiChar*>(text.data());
}

}  // namespace

std::vector<std::int8_t> reading_levels(const std::u32string& unmarked) {
    const std::u32string text = mark_figures(unmarked);
    const auto n = static_cast<FriBidiStrIndex>(text.size());
    std::vector<FriBidiCharType> types(text.size());
    std::vector<FriBidiBracketType> brackets(text.size());
    std::vector<FriBidiLevel> levels(text.size(), 0);
    fribidi_get_bidi_types(codes_of(text), n, types.data());
    fribidi_get_bracket_types(codes_of(text), n, types.data(), brackets.data());
    FriBidiParType line = FRIBIDI_PAR_LTR;
    if (fribidi_get_par_embedding_levels_ex(types.data(), brackets.data(), n, &line, levels.data()) == 0)
        std::fill(levels.begin(), levels.end(), FriBidiLevel{0});
    std::vector<std::int8_t> of_signs;
    for (std::size_t i = 0; i < text.size(); ++i)
        if (!orders_direction(text[i])) of_signs.push_back(levels[i]);
    return of_signs;
}

std::string visual_order(const std::string& line) {
    if (!may_read_leftwards(line)) return line;
    std::u32string text = code_points(line);
    std::erase_if(text, orders_direction);
    text = mark_figures(text);
    const auto n = static_cast<FriBidiStrIndex>(text.size());
    std::vector<FriBidiChar> visual(text.size() + 1);
    FriBidiParType whole = FRIBIDI_PAR_LTR;
    if (fribidi_log2vis(codes_of(text), n, &whole, visual.data(), nullptr, nullptr, nullptr) == 0) return line;
    std::string shown;
    for (std::size_t i = 0; i < text.size(); ++i)
        if (!has_no_ink(visual[i])) shown += utf8_of(static_cast<char32_t>(visual[i]));
    return shown;
}

}  // namespace planlight
