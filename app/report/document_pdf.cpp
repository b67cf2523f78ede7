#include <algorithm>

#include "app/report/document.h"
#include "app/report/pdf_table.h"
#include "app/report/pdf_words.h"

namespace planlight {
namespace {

using Face = PdfSheets::Face;

constexpr double kBody = 9, kCaption = 8, kHeading = 12, kTitle = 17, kVerdict = 12;
constexpr double kGap = 10;              ///< between figures beside each other
constexpr double kToSign = 38;           ///< what a line to sign takes
constexpr double kLeastOfPicture = 0.6;  ///< a picture is shrunk to that rather than moved to the next sheet
constexpr Rgb kRule{0xd5, 0xda, 0xdf};

Tone tone_of(PageVerdict::Kind kind) {
    return kind == PageVerdict::Kind::good ? Tone::good : kind == PageVerdict::Kind::look ? Tone::look : Tone::stop;
}

/// A chart's canvas: a place on a sheet.
class SheetCanvas : public ChartCanvas {
public:
    SheetCanvas(PdfSheets& sheets, double x, double top, double letters)
        : sheets_(sheets), x_(x), top_(top), letters_(letters) {}

    void line(const Points& points, Rgb colour, double thickness, bool dashed) override {
        Points there;
        for (const auto& [x, y] : points) there.emplace_back(x_ + x, top_ - y);
        sheets_.line(there, colour, thickness, dashed);
    }
    void rectangle(double x, double y, double width, double height, Rgb colour) override {
        sheets_.fill(x_ + x, top_ - y - height, width, height, colour);
    }
    void dot(double x, double y, double radius, Rgb colour) override { sheets_.dot(x_ + x, top_ - y, radius, colour); }
    void words(double x, double y, const std::string& words, Rgb colour, Anchor anchor, bool upwards) override {
        const double wide = sheets_.width_of(Face::regular, letters_, words), back = anchor == Anchor::start ? 0
                                                                                     : anchor == Anchor::middle
                                                                                         ? wide / 2
                                                                                         : wide;
        sheets_.words(Face::regular, letters_, colour, x_ + x - (upwards ? 0 : back), top_ - y - (upwards ? back : 0),
                      words, upwards);
    }

private:
    PdfSheets& sheets_;
    double x_, top_, letters_;
};

/// A row of figures as it will stand: how high the highest is, and the lines below each.
struct LaidRow {
    double width = 0, shown = 0, captions = 0;
    std::vector<std::vector<PdfLine>> lines;
    double height() const { return shown + captions; }
};

class PdfWriter {
public:
    /// `share`: of their size, that pictures have. `flowing`: no block begins a sheet because it is meant to.
    PdfWriter(const Document& document, PaperSize paper, double share, bool flowing = false)
        : document_(document), sheets_(document.title, document.foot, paper), share_(share), flowing_(flowing) {}

    std::size_t sheets() const { return sheets_.count(); }
    std::string bytes() { return sheets_.bytes(); }
    void write() {
        head();
        for (std::size_t i = 0; i < document_.blocks.size(); ++i) {
            next_ = i + 1 < document_.blocks.size() ? &document_.blocks[i + 1] : nullptr;
            std::visit(*this, document_.blocks[i]);
        }
        sheets_.need(kToSign * static_cast<double>(document_.signed_by.size()));  // they stand together
        for (const std::string& who : document_.signed_by) sign(who);
    }

    void operator()(const DocumentHeading& heading) {
        const auto lines = lines_of(sheets_, {heading.text}, kHeading, PdfSheets::width(), true);
        const double high = 10 + static_cast<double>(lines.size()) * leading_of(kHeading);
        sheets_.need(high + (next_ ? std::visit([&](const auto& block) { return least_height(block); }, *next_) : 0));
        sheets_.y -= sheets_.room() < sheets_.whole_room() ? 8 : 0;
        put(lines, kHeading);
        sheets_.y -= 2;
    }
    void operator()(const DocumentText& text) { paragraph(text, kBody, sheets_.left(), PdfSheets::width()); }
    void operator()(const DocumentTable& table) {
        PdfTable(sheets_, table, PdfSheets::width()).draw(sheets_.left());
        sheets_.y -= 3;
    }
    void operator()(const DocumentFigures& figures) {
        const std::vector<FigureRow> rows = rows_of(figures);
        for (const FigureRow& row : rows) row_of_figures(figures, row, &row == &rows.back());
        if (rows.empty()) beside(figures, sheets_.left(), PdfSheets::width());
    }
    void operator()(const DocumentScale& scale) {
        constexpr double kWide = 260, kHigh = 11;
        constexpr int kSteps = 130;
        sheets_.need(kHigh + 18);
        const double x = sheets_.left(), y = sheets_.y - 4 - kHigh;
        for (int i = 0; i < kSteps; ++i)
            sheets_.fill(x + kWide * i / kSteps, y, kWide / kSteps + 0.4, kHigh, colour_at(scale, (i + 0.5) / kSteps));
        for (const auto& [share, words] : scale.numbers) {
            const double wide = sheets_.width_of(Face::regular, kBody, words), back = share <= 0   ? 0
                                                                                      : share >= 1 ? wide
                                                                                                   : wide / 2;
            sheets_.words(Face::regular, kBody, ink_of(Tone::plain), x + kWide * share - back, y - 10, words);
        }
        sheets_.y = y - 16;
    }
    void operator()(const DocumentKey& key) {
        constexpr double kSquare = 8;
        sheets_.need(2 * leading_of(kBody));
        double x = sheets_.left();
        const double end = x + PdfSheets::width();
        sheets_.y -= leading_of(kBody);
        const auto say = [&](const std::string& words, std::optional<Rgb> colour) {
            const double wide = sheets_.width_of(Face::regular, kBody, words), all = wide + (colour ? kSquare + 4 : 0);
            if (x + all > end && x > sheets_.left()) {
                x = sheets_.left();
                sheets_.need(leading_of(kBody));
                sheets_.y -= leading_of(kBody);
            }
            if (colour) sheets_.fill(x, sheets_.y, kSquare, kSquare, *colour);
            sheets_.words(Face::regular, kBody, ink_of(colour ? Tone::plain : Tone::quiet), x + all - wide,
                          sheets_.y + 1, words);
            x += all + 12;
        };
        if (!key.lead.empty()) say(key.lead, std::nullopt);
        for (const auto& [colour, words] : key.colours) say(words, colour);
        sheets_.y -= 4;
    }
    void operator()(const NewSheet&) {
        if (!flowing_ && sheets_.room() < sheets_.whole_room()) sheets_.begin_sheet();
    }

private:
    void put(const std::vector<PdfLine>& lines, double size) { put(lines, size, sheets_.left()); }
    /// Line by line, on to the next sheet where there is no room.
    void put(const std::vector<PdfLine>& lines, double size, double x) {
        for (const PdfLine& line : lines) {
            sheets_.need(leading_of(size));
            draw_lines(sheets_, {line}, size, x, sheets_.y);
            sheets_.y -= leading_of(size);
        }
    }
    void paragraph(const DocumentText& text, double size, double x, double width) {
        put(lines_of(sheets_, text, size, width), size, x);
        sheets_.y -= 3;
    }

    void head() {
        put(lines_of(sheets_, {document_.title}, kTitle, PdfSheets::width(), true), kTitle);
        verdict();
        if (!document_.about.empty()) (*this)(DocumentText{document_.about, Tone::quiet});
        facts();
    }
    /// The sign and the sentence in a frame, and below it the reasons.
    void verdict() {
        constexpr double kInside = 8;
        const PageVerdict& v = document_.verdict;
        const Tone tone = tone_of(v.kind);
        if (!v.words.empty()) {
            const double sign = 1.6 * kVerdict;
            const auto lines =
                lines_of(sheets_, {v.words, tone}, kVerdict, PdfSheets::width() - 2 * kInside - sign, true);
            const double high = static_cast<double>(lines.size()) * leading_of(kVerdict) + kInside;
            sheets_.y -= 6;
            draw_lines(sheets_, {{{sign_of(v.kind), Face::bold, ink_of(tone)}}}, kVerdict, sheets_.left() + kInside,
                       sheets_.y - kInside / 2);
            draw_lines(sheets_, lines, kVerdict, sheets_.left() + kInside + sign, sheets_.y - kInside / 2);
            sheets_.y -= high;
            sheets_.frame(sheets_.left() + 0.75, sheets_.y, PdfSheets::width() - 1.5, high, ink_of(tone), 1.5);
            sheets_.y -= 5;
        }
        for (const std::string& reason : v.reasons) {
            const auto lines = lines_of(sheets_, {reason, tone}, kBody, PdfSheets::width() - 12);
            sheets_.need(leading_of(kBody));
            draw_lines(sheets_, {{{"•", Face::regular, ink_of(tone)}}}, kBody, sheets_.left() + 2, sheets_.y);
            put(lines, kBody, sheets_.left() + 12);
            sheets_.y -= 1;
        }
        if (!v.reasons.empty()) sheets_.y -= 2;
    }
    /// Name and value in two columns, read downwards.
    void facts() {
        constexpr double kName = 0.33;
        ReportFacts said;
        for (const auto& fact : document_.facts)
            if (!fact.second.empty()) said.push_back(fact);
        const std::size_t half = (said.size() + 1) / 2;
        const double column = (PdfSheets::width() - 2 * kGap) / 2;
        sheets_.y -= 4;
        rule();
        for (std::size_t i = 0; i < half; ++i) {
            std::vector<std::vector<PdfLine>> values;
            std::size_t most = 1;
            for (const std::size_t k : {i, i + half}) {
                if (k >= said.size()) break;
                for (const auto& [text, tone, share] : {std::tuple{said[k].first, Tone::quiet, kName},
                                                        std::tuple{said[k].second, Tone::plain, 1 - kName}}) {
                    values.push_back(lines_of(sheets_, {text, tone}, kBody, share * column - 4));
                    most = std::max(most, values.back().size());
                }
            }
            sheets_.need(static_cast<double>(most) * leading_of(kBody) + 2);
            for (std::size_t v = 0; v < values.size(); ++v)
                draw_lines(sheets_, values[v], kBody,
                           sheets_.left() + (v < 2 ? 0 : column + 2 * kGap) + (v % 2 == 0 ? 0 : kName * column),
                           sheets_.y);
            sheets_.y -= static_cast<double>(most) * leading_of(kBody) + 2;
            rule();
        }
        sheets_.y -= 3;
    }
    void rule() {
        sheets_.line({{sheets_.left(), sheets_.y + 0.5}, {sheets_.left() + PdfSheets::width(), sheets_.y + 0.5}}, kRule,
                     0.5);
    }

    LaidRow laid(const DocumentFigures& figures, const FigureRow& row) {
        LaidRow laid;
        const int columns = row.wide ? 1 : std::max(1, figures.columns);
        laid.width = (PdfSheets::width() - kGap * (columns - 1)) / columns;
        for (const std::size_t i : row.figures) {
            const DocumentFigure& figure = figures.figures[i];
            laid.shown =
                std::max(laid.shown, share_ * std::min(laid.width * aspect_of(figure), most_of_a_figure(row.wide)));
            std::vector<PdfLine> lines = lines_of(sheets_, {figure.title}, kCaption, laid.width, true);
            for (PdfLine& line : lines_of(sheets_, {figure.caption}, kCaption, laid.width))
                lines.push_back(std::move(line));
            laid.captions = std::max(laid.captions, static_cast<double>(lines.size()) * leading_of(kCaption) + 8);
            laid.lines.push_back(std::move(lines));
        }
        return laid;
    }
    double most_of_a_figure(bool wide) const { return (wide ? 0.42 : 0.6) * PdfSheets::width(); }

    void row_of_figures(const DocumentFigures& figures, const FigureRow& row, bool last) {
        LaidRow to_draw = laid(figures, row);
        if (to_draw.height() > sheets_.room()) {
            const double left_over = sheets_.room() - to_draw.captions;
            if (left_over >= kLeastOfPicture * to_draw.shown)
                to_draw.shown = left_over;
            else
                sheets_.begin_sheet();
        }
        const double top = sheets_.y - 2;
        double x = sheets_.left();
        for (std::size_t k = 0; k < row.figures.size(); ++k, x += to_draw.width + kGap) {
            figure(figures.figures[row.figures[k]], x, top, to_draw);
            draw_lines(sheets_, to_draw.lines[k], kCaption, x, top - to_draw.shown - 2);
        }
        double foot = top - to_draw.height();
        if (last && x < sheets_.left() + PdfSheets::width()) {
            beside(figures, x, sheets_.left() + PdfSheets::width() - x);
            foot = std::min(foot, sheets_.y - 4);
        }
        sheets_.y = foot;
    }
    /// In the middle of its place, as large as it may be there.
    void figure(const DocumentFigure& figure, double x, double top, const LaidRow& row) {
        if (const auto* chart = std::get_if<Chart>(&figure.shown)) {
            SheetCanvas canvas(sheets_, x, top, kCaption);
            chart->draw(canvas, row.width, row.shown, kCaption);
            return;
        }
        const double aspect = aspect_of(figure), width = std::min(row.width, row.shown / aspect),
                     height = width * aspect, at = x + (row.width - width) / 2, from = top - (row.shown + height) / 2;
        sheets_.picture(std::get<RgbImage>(figure.shown), at, from, width, height, document_.made_of_sheets);
        sheets_.frame(at, from, width, height, kRule, 0.5);
    }
    void beside(const DocumentFigures& figures, double x, double width) {
        for (const DocumentText& text : figures.beside) paragraph(text, kCaption, x, width);
        if (figures.table_beside) PdfTable(sheets_, *figures.table_beside, width).draw(x);
    }

    static Rgb colour_at(const DocumentScale& scale, double share) {
        if (scale.colours.empty()) return {255, 255, 255};
        const double at = share * static_cast<double>(scale.colours.size() - 1);
        const auto i = static_cast<std::size_t>(at), next = std::min(i + 1, scale.colours.size() - 1);
        Rgb mixed{};
        for (std::size_t c = 0; c < 3; ++c)
            mixed[c] = static_cast<std::uint8_t>(
                scale.colours[i][c] + (at - static_cast<double>(i)) * (scale.colours[next][c] - scale.colours[i][c]));
        return mixed;
    }

    void sign(const std::string& who) {
        constexpr double kBetween = 18;
        sheets_.y -= kToSign - leading_of(kCaption);
        double x = sheets_.left();
        const double room = PdfSheets::width() - 2 * kBetween;
        for (const auto& [words, share] : {std::pair{who, 5.0}, std::pair{std::string("Date, time"), 3.0},
                                           std::pair{std::string("Signature"), 6.0}}) {
            const double wide = room * share / 14;
            sheets_.line({{x, sheets_.y}, {x + wide, sheets_.y}}, ink_of(Tone::plain), 0.75);
            draw_lines(sheets_, {{{words, Face::regular, ink_of(Tone::quiet)}}}, kCaption, x, sheets_.y - 1);
            x += wide + kBetween;
        }
        sheets_.y -= leading_of(kCaption);
    }

    /// How much of a block must stand below its heading.
    double least_height(const DocumentFigures& figures) {
        const std::vector<FigureRow> rows = rows_of(figures);
        if (rows.empty()) return 3 * leading_of(kBody);
        const LaidRow first = laid(figures, rows.front());
        return kLeastOfPicture * first.shown + first.captions + 4;
    }
    double least_height(const DocumentTable& table) {
        return PdfTable(sheets_, table, PdfSheets::width()).least_height();
    }
    double least_height(const DocumentText& text) {
        const auto lines = lines_of(sheets_, text, kBody, PdfSheets::width());
        return static_cast<double>(std::min<std::size_t>(3, lines.size())) * leading_of(kBody);
    }
    template <class Block>
    double least_height(const Block&) {
        return 4 * leading_of(kBody);
    }

    const Document& document_;
    PdfSheets sheets_;
    double share_;
    bool flowing_;
    const DocumentBlock* next_ = nullptr;
};

/// How many sheets are meant: as many as it is made of; else one less than it takes, lest a few lines stand alone.
std::size_t sheets_wanted(const Document& document, std::size_t taken) {
    if (!document.made_of_sheets) return taken - 1;
    const auto breaks = std::count_if(document.blocks.begin(), document.blocks.end(), [](const DocumentBlock& block) {
        return std::holds_alternative<NewSheet>(block);
    });
    return static_cast<std::size_t>(breaks) + 1;
}

}  // namespace

/// Pictures give way where that saves a sheet, as far as they can still be judged; and then the places where sheets are
/// meant to begin, which many warnings move.
std::string pdf_of(const Document& document, PaperSize paper) {
    PdfWriter whole(document, paper, 1);
    whole.write();
    const std::size_t wanted = sheets_wanted(document, whole.sheets());
    if (wanted > 0 && whole.sheets() > wanted)
        for (const bool flowing : {false, true})
            for (const double share : {1.0, 0.9, 0.8, 0.7, 0.6}) {
                if (share == 1 && !flowing) continue;  // that is the whole
                if (!document.made_of_sheets && (flowing || share < 0.75)) break;
                PdfWriter smaller(document, paper, share, flowing);
                smaller.write();
                if (smaller.sheets() <= wanted) return smaller.bytes();
            }
    return whole.bytes();
}

}  // namespace planlight
