#pragma once

#include <string>
#include <vector>

#include "app/report/pdf_sheets.h"

namespace planlight {

/// Words of one look on a line.
struct PdfRun {
    std::string text;
    PdfSheets::Face face = PdfSheets::Face::regular;
    Rgb ink{0, 0, 0};
};
using PdfLine = std::vector<PdfRun>;

/// Of the page's colours, for paper.
Rgb ink_of(Tone tone);

/// The text in lines of that width, points; a word that is longer is broken. `bold`: all of it.
std::vector<PdfLine> lines_of(const PdfSheets& sheets, const DocumentText& text, double size, double width,
                              bool bold = false);

/// How wide it is on one line, and its longest word.
struct PdfWidths {
    double whole = 0, longest_word = 0;
};
PdfWidths widths_of(const PdfSheets& sheets, const DocumentText& text, double size);

/// How far lines of that size are from each other.
double leading_of(double size);

/// The lines from there downwards, the first one's top at `y`. Nothing else is moved.
void draw_lines(PdfSheets& sheets, const std::vector<PdfLine>& lines, double size, double x, double y);

}  // namespace planlight
