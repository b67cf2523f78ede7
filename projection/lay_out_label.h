#pragma once

#include <optional>
#include <string>
#include <vector>

#include "projection/lettering.h"

namespace planlight {

/// What a label says of a risk structure.
struct RiskText {
    std::string figure;     ///< "4.1 mm to", "through": never cut
    std::string structure;  ///< "Facial nerve": on the figure's line where it has room, else below it
    std::string more;       ///< "and 2 more": others that warn; empty: none
    bool warns = false;     ///< under 2 mm, or through
    double mm = 0;          ///< 0: through
    bool apart = false;     ///< on two lines, however short
};

/// What a label says: a name, and figures with their units.
struct LabelText {
    std::string name;
    std::vector<std::string> figures;  ///< "7 mm wide", "6 mm deep": each whole on one line
    std::optional<RiskText> risk = {};
};

/// A label's lines, laid out: (0,0) in the middle, x along the lines, y up, mm.
struct TextBlock {
    struct Line {
        TextOutline text;
        Eigen::Vector2d begins_mm;  ///< its baseline's left end
    };
    std::vector<Line> lines;
    double width_mm = 0, height_mm = 0;  ///< of the ink
    std::string words;                   ///< as it can be read, lines parted by a line feed
};

/// The longest line of a label, mm: its ends are so far from its middle that the map to the skin is still true there.
inline constexpr double kMaxLine_mm = 44;

/// Lines of a label with capitals so high. A name too long for a line stands on two, and is shortened in the middle
/// where that is not enough; each figure has a line of its own, so that no two are read as one; a structure's name is
/// treated as the item's, below its figure where both are too long for one line. Nothing when a font
/// lacks a sign of it.
TextBlock lay_out(const LabelText& text, double text_height_mm, const Lettering& letters = lettering());

/// The name as a label has it: whole, or shortened in the middle ("Osteotomie lin…temporal").
std::string shortened(const std::string& name, double text_height_mm, const Lettering& letters = lettering());

}  // namespace planlight
