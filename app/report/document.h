#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "app/report/chart.h"
#include "app/report/html_page.h"

namespace planlight {

/// How words of a document are meant: as they are, of less weight, or good, to be looked at, to be stopped for.
enum class Tone { plain, quiet, good, look, stop };

/// Words of a paragraph or of a cell.
struct DocumentText {
    std::string text;
    Tone tone = Tone::plain;
    std::string lead = {};   ///< bold, before the text
    std::string below = {};  ///< quiet, on a line of its own below it
};

struct DocumentHeading {
    std::string text;
};

/// Rows are broken between sheets, never within; the names of the columns stand on each sheet.
struct DocumentTable {
    enum class Kind { words, figure, name };  ///< `figure`: never broken into lines; `name`: the widest
    struct Column {
        std::string name;
        Kind kind = Kind::words;
    };
    std::vector<Column> columns;
    std::vector<std::vector<DocumentText>> rows;
    bool dense = false;  ///< many columns of words: smaller, all begin at the left; else all but the first are figures
};

/// Something to look at, with what it shows.
struct DocumentFigure {
    std::string title, caption;
    std::variant<RgbImage, Chart> shown;
};

/// Figures in rows of `columns`. With two columns, one more than twice as wide as high has a row of its own, and so has
/// the last of an odd number: no place stays empty.
struct DocumentFigures {
    std::vector<DocumentFigure> figures;
    int columns = 2;
    /// Beside the last row, in its free places; empty: nothing.
    std::vector<DocumentText> beside = {};
    std::optional<DocumentTable> table_beside = {};
};

/// What the colours of pictures stand for: they run evenly from the first to the last.
struct DocumentScale {
    std::vector<Rgb> colours;
    std::vector<std::pair<double, std::string>> numbers;  ///< at which share of the width
};

/// Which colour in pictures is what.
struct DocumentKey {
    std::string lead;
    std::vector<std::pair<Rgb, std::string>> colours;
};

/// What follows begins on a sheet of its own.
struct NewSheet {};

using DocumentBlock =
    std::variant<DocumentHeading, DocumentText, DocumentTable, DocumentFigures, DocumentScale, DocumentKey, NewSheet>;

/// A report: filled once, written for the screen (`html_of`) and for paper (`pdf_of`), with the same content in the
/// same order, so that neither can say what the other does not.
struct Document {
    std::string title;
    std::string about = {};  ///< a quiet line below the verdict; empty: none
    PageVerdict verdict = {};
    ReportFacts facts = {};  ///< all of them: see `with_program`
    std::vector<DocumentBlock> blocks = {};
    std::vector<std::string> signed_by = {};
    std::string foot = {};        ///< at the foot of every sheet, before its number
    bool made_of_sheets = false;  ///< HTML laid out for paper too, pictures without any loss
};

/// The figures of a row by their numbers; `wide`: the only one, over all columns.
struct FigureRow {
    std::vector<std::size_t> figures;
    bool wide = false;
};

/// As they stand beneath each other.
std::vector<FigureRow> rows_of(const DocumentFigures& figures);

/// Height of a figure by its width.
double aspect_of(const DocumentFigure& figure);

/// Pictures as figures of a document.
DocumentFigures figures_of(const std::vector<ReportPicture>& pictures, int columns = 2);

/// "Planlight 1.2. For research; not a medical device."
std::string foot_of_program();

/// One self-contained page for the screen that also prints well, no network.
std::string html_of(const Document& document);

enum class PaperSize { a4, letter };

/// The bytes of a PDF. Throws DeviceError where its font is not installed.
std::string pdf_of(const Document& document, PaperSize paper = PaperSize::a4);

}  // namespace planlight
