#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "projection/font_files.h"

namespace planlight {

/// One sign of a text as closed outlines to be filled together (a hole runs the other way round); y up, (0,0) where the
/// text begins on its baseline. Unit: the first font's capital letters are 1 high. Points are so close that the lines
/// between them follow the font's curves to a hundredth.
struct Sign {
    std::vector<std::vector<Eigen::Vector2d>> outlines;
};

/// A line of text as it is read, its signs from left to right.
struct TextOutline {
    std::vector<Sign> signs;
    double width = 0;             ///< from (0,0) to where the next text would begin
    double low = 0, high = 0;     ///< of the ink
    std::vector<char32_t> lacks;  ///< what no font has: then nothing of the text may be shown. Empty when all is well
};

/// Letters of any language: outlines by FreeType, shaped by HarfBuzz (joined Arabic, Devanagari, accents that are signs
/// of their own), in the order in which they are read by FriBidi. May be used by several threads. Costs time: make the
/// outlines ahead, none per picture.
class Lettering {
public:
    /// With these fonts, each used for what the ones before it lack. Files that cannot be read are passed over. Without
    /// any the single-line font draws what it has (Western European letters).
    explicit Lettering(const std::vector<FontFile>& fonts);
    ~Lettering();

    /// One line of UTF-8 text. Control signs are left out, and those that order a direction of reading: letters and
    /// figures stand in the order of their own script, as in every window.
    TextOutline outline(const std::string& utf8) const;

    /// Families in use so far, the first font always; empty without fonts.
    std::vector<std::string> families() const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

/// That of this computer's fonts (`font_files`), made by the first who asks.
const Lettering& lettering();

}  // namespace planlight
