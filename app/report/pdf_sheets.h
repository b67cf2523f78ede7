#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "app/report/document.h"
#include "planning_io/types/image.h"

namespace planlight {

/// Sheets of paper that are drawn on, from the top to the bottom. Text is UTF-8 in an embedded font. Lengths on the
/// paper are points of 1/72 inch, x to the right, y upwards from the sheet's lower edge.
class PdfSheets {
public:
    enum class Face { regular, bold };
    using Points = std::vector<std::pair<double, double>>;

    /// `foot` stands at the foot of every sheet, with its number and how many there are. Throws DeviceError, with the
    /// package, where the font DejaVu Sans is not installed.
    PdfSheets(const std::string& title, const std::string& foot, PaperSize paper);
    ~PdfSheets();

    /// The content is as wide on both sizes of paper.
    double left() const;
    static constexpr double width() { return 521; }
    /// Where the free room of the sheet begins, to be moved by whoever fills it.
    double y = 0;
    /// What is free below `y`, and on an empty sheet.
    double room() const;
    double whole_room() const;
    void begin_sheet();
    std::size_t count() const;
    /// A new sheet where less than that is free.
    void need(double height);

    double width_of(Face face, double size, const std::string& words) const;
    /// From that point of their base line on; `upwards`: from there to the top of the sheet.
    void words(Face face, double size, Rgb ink, double x, double y, const std::string& words, bool upwards = false);
    void line(const Points& points, Rgb ink, double thickness, bool dashed = false);
    void fill(double x, double y, double width, double height, Rgb ink);
    void frame(double x, double y, double width, double height, Rgb ink, double thickness);
    void dot(double x, double y, double radius, Rgb ink);
    /// Not `exact`: as JPEG where that is smaller.
    void picture(const RgbImage& picture, double x, double y, double width, double height, bool exact);

    /// The bytes of the file; nothing can be drawn afterwards.
    std::string bytes();

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace planlight
