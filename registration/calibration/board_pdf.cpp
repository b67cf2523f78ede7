#include <fmt/format.h>

#include <array>
#include <vector>

#include "registration/calibration/draw_board.h"

namespace planlight {
namespace {

constexpr double kPoints = 72 / 25.4;  ///< a mm in PDF units
constexpr double kMargin_mm = 10, kText_mm = 12;

struct Page {
    double width_mm, height_mm;
};

/// The smallest usual sheet that holds the board and its text, else one of the board's own size.
Page page_for(const BoardSpec& board) {
    const double w = board.width_mm() + 2 * kMargin_mm, h = board.height_mm() + 2 * kMargin_mm + kText_mm;
    for (const Page& page : {Page{210, 297}, Page{297, 210}, Page{297, 420}, Page{420, 297}})
        if (w <= page.width_mm && h <= page.height_mm) return page;
    return {w, h};
}

/// Dark modules as rectangles, runs joined; PDF counts from the lower left corner.
std::string rectangles(const BoardSpec& board, double left_mm, double top_mm, double page_height_mm) {
    const GrayImage modules = board_modules(board);
    const double module_mm = board.square_mm / kModulesPerSquare;
    std::string text = fmt::format("{:.3f} g\n", kBoardDark / 255.0);
    for (int y = 0; y < modules.height; ++y)
        for (int x = 0; x < modules.width;) {
            int end = x;
            while (end < modules.width && modules.at(end, y) == 0) ++end;
            if (end > x)
                text += fmt::format("{:.4f} {:.4f} {:.4f} {:.4f} re\n", (left_mm + x * module_mm) * kPoints,
                                    (page_height_mm - top_mm - (y + 1) * module_mm) * kPoints,
                                    (end - x) * module_mm * kPoints, module_mm * kPoints);
            x = std::max(end, x + 1);
        }
    return text + "f\n";
}

std::string caption(const BoardSpec& board, double left_mm) {
    const auto line = [&](double up_mm, const std::string& words) {
        return fmt::format("BT /F1 9 Tf 0.2 g {:.3f} {:.3f} Td ({}) Tj ET\n", left_mm * kPoints, up_mm * kPoints,
                           words);
    };
    return line(kMargin_mm + 4.5, fmt::format("Planlight board: {}", text_of(board))) +
           line(kMargin_mm,
                fmt::format("Print at 100 %, glue it flat, then measure: {} squares must be {:.1f} mm; if not, "
                            "give the square you measured.",
                            board.squares_across(), board.width_mm()));
}

}  // namespace

std::string board_pdf(const BoardSpec& board) {
    const Page page = page_for(board);
    const double left_mm = (page.width_mm - board.width_mm()) / 2;
    const double top_mm = (page.height_mm - kText_mm - board.height_mm()) / 2;
    const std::string content = rectangles(board, left_mm, top_mm, page.height_mm) + caption(board, left_mm);
    const std::vector<std::string> objects{
        "<< /Type /Catalog /Pages 2 0 R /ViewerPreferences << /PrintScaling /None >> >>",
        "<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
        fmt::format("<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {:.4f} {:.4f}] /Contents 4 "
                    "0 R /Resources << /Font << /F1 5 0 R >> >> >>",
                    page.width_mm * kPoints, page.height_mm * kPoints),
        fmt::format("<< /Length {} >>\nstream\n{}endstream", content.size(), content),
        "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica >>"};
    std::string file = "%PDF-1.4\n";
    std::string table = fmt::format("xref\n0 {}\n0000000000 65535 f \n", objects.size() + 1);
    for (std::size_t i = 0; i < objects.size(); ++i) {
        table += fmt::format("{:010} 00000 n \n", file.size());
        file += fmt::format("{} 0 obj\n{}\nendobj\n", i + 1, objects[i]);
    }
    const std::size_t start = file.size();
    return file + table +
           fmt::format("trailer\n<< /Size {} /Root 1 0 R >>\nstartxref\n{}\n%%EOF\n", objects.size() + 1, start);
}

}  // namespace planlight
