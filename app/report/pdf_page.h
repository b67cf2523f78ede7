#pragma once

#include <memory>
#include <string>
#include <vector>

#include "planning_io/types/image.h"

namespace planlight {

/// A document of A4 sheets, written from the top to the bottom: headings, sentences, tables, pictures, a chart. Text is
/// UTF-8 in an embedded font. Lengths on the paper are points of 1/72 inch.
class PdfPages {
public:
    /// `foot` stands at the foot of every sheet, with its number. Throws DeviceError, with the package, where the font
    /// DejaVu Sans is not installed.
    PdfPages(const std::string& title, const std::string& foot);
    ~PdfPages();

    /// On the same sheet as what follows, which is so high at least.
    void heading(const std::string& text, double with = 0);
    void paragraph(const std::string& text);
    /// `shares`: of the width, one a column. The first row is the heading's.
    void table(const std::vector<std::vector<std::string>>& rows, const std::vector<double>& shares);
    /// Pictures beside each other, each with its caption.
    void pictures(const std::vector<std::pair<std::string, RgbImage>>& row);

    /// Of a chart: dots, lines and bars in its own numbers.
    struct Chart {
        double from_x = 0, to_x = 1, to_y = 1;  ///< y begins at 0
        std::string x_label, y_label;
        struct Bar {
            double from = 0, to = 0, height = 0;
            Rgb colour{};
        };
        std::vector<Bar> bars;
        std::vector<std::pair<double, double>> dots;
        std::vector<std::pair<double, Rgb>> levels;  ///< lines over the whole width
    };
    void chart(const Chart& chart);

    /// The bytes of the file.
    std::string bytes();

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace planlight
