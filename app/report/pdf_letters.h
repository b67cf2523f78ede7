#pragma once

#include <optional>
#include <string>
#include <vector>

#include "projection/lettering.h"

namespace planlight {

/// A piece of a line of text on paper.
struct PdfLetters {
    std::string text;                    ///< of the document's own font
    std::optional<TextOutline> outline;  ///< or drawn: what that font lacks, joins, or reads from right to left
};

/// A line of UTF-8 as pieces from left to right. Latin, Greek and Cyrillic letters stay text, which a reader of the
/// document can search. Words of other scripts (Chinese, Arabic, Hindi) are outlines, and with one that is read from
/// right to left the whole line is, in the order in which it is read. What no font of this computer has stays text.
std::vector<PdfLetters> letters_of(const std::string& line);

}  // namespace planlight
