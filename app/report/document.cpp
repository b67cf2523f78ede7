#include "app/report/document.h"

namespace planlight {

double aspect_of(const DocumentFigure& figure) {
    const auto* picture = std::get_if<RgbImage>(&figure.shown);
    const int width = picture ? picture->width : std::get<Chart>(figure.shown).width(),
              height = picture ? picture->height : std::get<Chart>(figure.shown).height();
    return width > 0 ? static_cast<double>(height) / width : 1;
}

std::vector<FigureRow> rows_of(const DocumentFigures& of) {
    const auto is_wide = [&](std::size_t i) { return of.columns < 3 && aspect_of(of.figures[i]) < 0.5; };
    const std::size_t columns = static_cast<std::size_t>(std::max(1, of.columns));
    std::vector<FigureRow> rows;
    FigureRow row;
    for (std::size_t i = 0; i < of.figures.size(); ++i) {
        row.figures.push_back(i);
        const bool last = i + 1 == of.figures.size(), before_wide = !last && is_wide(i + 1);
        row.wide = columns < 3 && row.figures.size() == 1 && (is_wide(i) || last || before_wide);
        if (row.wide || last || before_wide || row.figures.size() == columns) rows.push_back(std::exchange(row, {}));
    }
    return rows;
}

DocumentFigures figures_of(const std::vector<ReportPicture>& pictures, int columns) {
    DocumentFigures figures{{}, columns};
    for (const ReportPicture& picture : pictures)
        figures.figures.push_back({picture.title, picture.caption, picture.picture});
    return figures;
}

std::string foot_of_program() {
    return program_name() + ". For research; not a medical device.";
}

}  // namespace planlight
