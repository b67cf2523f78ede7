#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace planlight {

/// One sign of the single-line font, as lines to draw; y up, (0,0) on the baseline at its left edge.
///
/// Unit: capital letters are 1 high; descenders reach -1/3.
struct Glyph {
    std::vector<std::vector<Eigen::Vector2d>> lines;
    double width = 0;    ///< of the ink
    double advance = 0;  ///< to the next sign
};

/// The sign for a Unicode code point: ASCII, the diameter and degree signs, and the letters of Western European names.
/// An unknown one is drawn as a question mark, so that it is seen to be missing.
Glyph glyph(char32_t code);

/// True when the font has a sign for it.
bool is_known_glyph(char32_t code);

/// The code points of UTF-8 text; a damaged byte becomes U+FFFD.
std::u32string code_points(const std::string& utf8);

/// Width of one line of text, in the unit above.
double text_width(const std::u32string& text);

}  // namespace planlight
