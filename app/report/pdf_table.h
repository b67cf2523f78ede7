#pragma once

#include <vector>

#include "app/report/pdf_words.h"

namespace planlight {

/// A table on sheets of paper: each column as wide as what stands in it asks for, together as wide as there is room.
class PdfTable {
public:
    PdfTable(PdfSheets& sheets, const DocumentTable& table, double width);

    double height() const;
    /// Of the names and the first rows: less than that shall not stand alone at the foot of a sheet.
    double least_height() const;
    /// From the free room's beginning on, which it moves. Rows stand whole on a sheet, but for one that is higher than
    /// a sheet.
    void draw(double x);

private:
    struct Row {
        std::vector<std::vector<PdfLine>> cells;
        std::size_t lines = 1;
        double letters = 0;
    };
    Row row_of(const std::vector<DocumentText>& cells, double letters) const;
    void share_width(const DocumentTable& table, double width);
    double height_of(const Row& row) const;
    void draw_row(const Row& row, double x, std::size_t from, std::size_t count);
    void draw_high_row(const Row& row, double x);

    PdfSheets& sheets_;
    double letters_;
    bool dense_;
    std::vector<double> widths_;
    Row names_;
    std::vector<Row> rows_;
};

}  // namespace planlight
