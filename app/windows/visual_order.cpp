#include "app/windows/visual_order.h"

#include <fribidi/fribidi.h>

#include <algorithm>
#include <vector>

#include "projection/stroke_font.h"
#include "projection/text_signs.h"

namespace planlight {
namespace {

/// Letters from U+0590 on begin with such a byte: most lines have none, and are told at once.
bool may_read_leftwards(const std::string& line) {
    return std::any_of(line.begin(), line.end(), [](char c) { return static_cast<unsigned char>(c) >= 0xD6U; });
}

}  // namespace

std::string visual_order(const std::string& line) {
    if (!may_read_leftwards(line)) return line;
    std::u32string text = code_points(line);
    std::erase_if(text, orders_direction);
    text = mark_figures(text);
    const auto count = static_cast<FriBidiStrIndex>(text.size());
    const auto* logical = reinterpret_cast<const FriBidiChar*>(text.data());
    std::vector<FriBidiCharType> types(text.size());
    fribidi_get_bidi_types(logical, count, types.data());
    if (std::none_of(types.begin(), types.end(), [](FriBidiCharType type) { return FRIBIDI_IS_RTL(type); }))
        return line;
    std::vector<FriBidiChar> visual(text.size() + 1);
    FriBidiParType whole = FRIBIDI_PAR_ON;
    if (fribidi_log2vis(logical, count, &whole, visual.data(), nullptr, nullptr, nullptr) == 0) return line;
    std::string shown;
    for (std::size_t i = 0; i < text.size(); ++i)
        if (!has_no_ink(visual[i])) shown += utf8_of(static_cast<char32_t>(visual[i]));
    return shown;
}

}  // namespace planlight
