#include "app/report/pdf_table.h"

#include <algorithm>
#include <numeric>

namespace planlight {
namespace {

constexpr double kGap = 7, kUnder = 3.5;  ///< between columns, and below a row with its rule
constexpr Rgb kRule{0xd5, 0xda, 0xdf};

/// How narrow a cell's column may be.
double least_of(DocumentTable::Kind kind, const PdfWidths& cell, double table) {
    if (kind == DocumentTable::Kind::figure) return cell.whole;
    return kind == DocumentTable::Kind::name ? std::min(cell.whole, 0.18 * table)
                                             : std::min(cell.longest_word, 0.3 * table);
}

double width_of(const PdfSheets& sheets, const PdfLine& line, double size) {
    double all = 0;
    for (const PdfRun& run : line) all += sheets.width_of(run.face, size, run.text);
    return all;
}

}  // namespace

PdfTable::PdfTable(PdfSheets& sheets, const DocumentTable& table, double width)
    : sheets_(sheets), letters_(table.dense || table.columns.size() > 6 ? 8 : 9), dense_(table.dense) {
    share_width(table, width);
    std::vector<DocumentText> names;
    for (const auto& column : table.columns) names.push_back({column.name, Tone::quiet});
    if (std::any_of(names.begin(), names.end(), [](const DocumentText& name) { return !name.text.empty(); }))
        names_ = row_of(names, 7.5);
    for (const auto& row : table.rows) rows_.push_back(row_of(row, letters_));
}

/// What all columns have above what they need goes to those that would be wider, by how much wider.
void PdfTable::share_width(const DocumentTable& table, double width) {
    std::vector<double> least, wanted;
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
        const auto& column = table.columns[c];
        PdfWidths most = widths_of(sheets_, {column.name}, 7.5);
        most.whole = std::min(most.whole, std::max(most.longest_word, 60.0));  // a name is broken rather than a cell
        for (const auto& row : table.rows) {
            if (c >= row.size()) continue;
            const PdfWidths of = widths_of(sheets_, row[c], letters_);
            most.whole = std::max(most.whole, of.whole);
            most.longest_word = std::max(most.longest_word, least_of(column.kind, of, width));
        }
        least.push_back(std::min(most.longest_word, 0.6 * width) + kGap);
        wanted.push_back(std::max(most.whole + kGap, least.back()));
    }
    const double all_least = std::accumulate(least.begin(), least.end(), 0.0),
                 all_wanted = std::accumulate(wanted.begin(), wanted.end(), 0.0);
    for (std::size_t c = 0; c < least.size(); ++c) {
        if (all_least >= width)
            widths_.push_back(least[c] * width / all_least);
        else if (all_wanted <= width)
            widths_.push_back(wanted[c] * width / all_wanted);
        else
            widths_.push_back(least[c] + (width - all_least) * (wanted[c] - least[c]) / (all_wanted - all_least));
    }
}

PdfTable::Row PdfTable::row_of(const std::vector<DocumentText>& cells, double letters) const {
    Row row;
    row.letters = letters;
    for (std::size_t c = 0; c < std::min(cells.size(), widths_.size()); ++c) {
        row.cells.push_back(lines_of(sheets_, cells[c], letters, widths_[c] - kGap + 0.01));
        row.lines = std::max(row.lines, row.cells.back().size());
    }
    return row;
}

double PdfTable::height_of(const Row& row) const {
    return row.cells.empty() ? 0 : static_cast<double>(row.lines) * leading_of(row.letters) + kUnder;
}

double PdfTable::height() const {
    return std::accumulate(rows_.begin(), rows_.end(), height_of(names_),
                           [&](double sum, const Row& row) { return sum + height_of(row); });
}

double PdfTable::least_height() const {
    double least = height_of(names_);
    for (std::size_t r = 0; r < std::min<std::size_t>(2, rows_.size()); ++r) least += height_of(rows_[r]);
    return std::min(least, 0.5 * sheets_.whole_room());
}

void PdfTable::draw_row(const Row& row, double x, std::size_t from, std::size_t count) {
    const double width = std::accumulate(widths_.begin(), widths_.end(), 0.0), end = x + width;
    for (std::size_t c = 0; c < row.cells.size(); ++c) {
        const auto& lines = row.cells[c];
        const bool to_the_right = !dense_ && c > 0;
        for (std::size_t i = from; i < std::min(from + count, lines.size()); ++i) {
            const double aside = to_the_right ? widths_[c] - kGap - width_of(sheets_, lines[i], row.letters) : 0;
            draw_lines(sheets_, {lines[i]}, row.letters, x + std::max(0.0, aside),
                       sheets_.y - static_cast<double>(i - from) * leading_of(row.letters));
        }
        x += widths_[c];
    }
    sheets_.y -= static_cast<double>(std::min(count, row.lines - from)) * leading_of(row.letters) + kUnder;
    sheets_.line({{end - width, sheets_.y + 1.5}, {end, sheets_.y + 1.5}}, kRule, 0.5);
}

/// A row that no sheet can hold goes on on the next.
void PdfTable::draw_high_row(const Row& row, double x) {
    for (std::size_t from = 0; from < row.lines;) {
        const double free = sheets_.room() - kUnder;
        const auto fit = static_cast<std::size_t>(std::max(0.0, free / leading_of(row.letters)));
        if (fit < 3) {
            sheets_.begin_sheet();
            draw_row(names_, x, 0, names_.lines);
            continue;
        }
        draw_row(row, x, from, fit);
        from += fit;
    }
}

void PdfTable::draw(double x) {
    sheets_.need(least_height());
    if (!names_.cells.empty()) draw_row(names_, x, 0, names_.lines);
    for (const Row& row : rows_) {
        if (height_of(names_) + height_of(row) > sheets_.whole_room()) {
            draw_high_row(row, x);
            continue;
        }
        if (height_of(row) > sheets_.room()) {
            sheets_.begin_sheet();
            if (!names_.cells.empty()) draw_row(names_, x, 0, names_.lines);
        }
        draw_row(row, x, 0, row.lines);
    }
}

}  // namespace planlight
