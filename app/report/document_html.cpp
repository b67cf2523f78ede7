#include <fmt/format.h>

#include <algorithm>

#include "app/report/document.h"
#include "app/report/paper_page.h"

namespace planlight {
namespace {

const char* class_of(Tone tone) {
    constexpr const char* kClasses[] = {"", "muted", "good", "look", "stop"};
    return kClasses[static_cast<std::size_t>(tone)];
}

std::string toned(const DocumentText& text) {
    if (text.tone == Tone::plain) return xml_escaped(text.text);
    return fmt::format("<span class=\"{}\">{}</span>", class_of(text.tone), xml_escaped(text.text));
}

std::string words_html(const DocumentText& text) {
    std::string html = text.lead.empty() ? "" : fmt::format("<b>{}</b>&ensp;", xml_escaped(text.lead));
    html += toned(text);
    return html + (text.below.empty() ? "" : "<br>" + toned({text.below, Tone::quiet}));
}

/// A column of figures that are no numbers on a line of their own is the browser's to break.
const char* class_of(const DocumentTable& table, std::size_t column) {
    if (!table.dense || column >= table.columns.size()) return "";
    constexpr const char* kClasses[] = {" class=\"words\"", " class=\"figure\"", " class=\"name\""};
    return kClasses[static_cast<std::size_t>(table.columns[column].kind)];
}

std::string table_html(const DocumentTable& table) {
    std::string html = fmt::format(
        "<table{}>", table.dense ? fmt::format(" class=\"plan{}\"", table.columns.size() > 8 ? " tight" : "") : "");
    const bool named = std::any_of(table.columns.begin(), table.columns.end(),
                                   [](const DocumentTable::Column& column) { return !column.name.empty(); });
    if (named) {
        html += "<thead><tr>";
        for (const auto& column : table.columns) html += "<th>" + xml_escaped(column.name) + "</th>";
        html += "</tr></thead>";
    }
    for (const auto& row : table.rows) {
        html += "<tr>";
        for (std::size_t c = 0; c < row.size(); ++c)
            html += fmt::format("<td{}>{}</td>", class_of(table, c), words_html(row[c]));
        html += "</tr>";
    }
    return html + "</table>";
}

class Writer {
public:
    explicit Writer(const Document& document) : sheets_(document.made_of_sheets) {}

    std::string operator()(const DocumentHeading& heading) const {
        return "<h2>" + xml_escaped(heading.text) + "</h2>";
    }
    std::string operator()(const DocumentText& text) const {
        const std::string of_class = text.tone == Tone::plain ? "" : fmt::format(" class=\"{}\"", class_of(text.tone));
        return fmt::format("<p{}>{}</p>", of_class, words_html({text.text, Tone::plain, text.lead, text.below}));
    }
    std::string operator()(const DocumentTable& table) const { return table_html(table); }
    std::string operator()(const DocumentFigures& figures) const {
        std::string html = fmt::format("<div class=\"row\" style=\"grid-template-columns:repeat({},1fr)\">",
                                       std::max(1, figures.columns));
        for (const FigureRow& row : rows_of(figures))
            for (const std::size_t i : row.figures) html += figure_html(figures.figures[i], row.wide);
        if (!figures.beside.empty() || figures.table_beside)
            html += "<div class=\"small\">" + beside_html(figures) + "</div>";
        return html + "</div>";
    }
    std::string operator()(const DocumentScale& scale) const {
        std::string svg = "<svg class=\"scale\" viewBox=\"0 0 460 44\"><defs><linearGradient id=\"scale\">";
        for (std::size_t i = 0; i < scale.colours.size(); ++i)
            svg += fmt::format(
                "<stop offset=\"{:.3f}\" stop-color=\"{}\"/>",
                static_cast<double>(i) / static_cast<double>(std::max<std::size_t>(1, scale.colours.size() - 1)),
                web_colour(scale.colours[i]));
        svg += "</linearGradient></defs><rect x=\"10\" width=\"440\" height=\"18\" fill=\"url(#scale)\"/>";
        for (const auto& [share, words] : scale.numbers)
            svg += fmt::format("<text x=\"{:.0f}\" y=\"38\" font-size=\"16\" text-anchor=\"{}\">{}</text>",
                               10 + 440 * share,
                               share <= 0   ? "start"
                               : share >= 1 ? "end"
                                            : "middle",
                               xml_escaped(words));
        return svg + "</svg>";
    }
    std::string operator()(const DocumentKey& key) const {
        std::string html =
            "<div class=\"key\">" + (key.lead.empty() ? "" : "<span>" + xml_escaped(key.lead) + "</span>");
        for (const auto& [colour, words] : key.colours)
            html +=
                fmt::format("<span><i style=\"background:{}\"></i>{}</span>", web_colour(colour), xml_escaped(words));
        return html + "</div>";
    }
    std::string operator()(const NewSheet&) const { return sheets_ ? "</section><section class=\"sheet\">" : ""; }

private:
    std::string beside_html(const DocumentFigures& figures) const {
        std::string html;
        for (const DocumentText& text : figures.beside) html += (*this)(text);
        return html + (figures.table_beside ? table_html(*figures.table_beside) : "");
    }
    std::string figure_html(const DocumentFigure& figure, bool wide) const {
        const auto* picture = std::get_if<RgbImage>(&figure.shown);
        const std::string shown = picture ? fmt::format("<img alt=\"{}\" src=\"{}\">", xml_escaped(figure.title),
                                                        embedded_picture(*picture, sheets_))
                                          : std::get<Chart>(figure.shown).svg();
        return fmt::format("<figure{}>{}<figcaption><b>{}</b> {}</figcaption></figure>", wide ? " class=\"wide\"" : "",
                           shown, xml_escaped(figure.title), xml_escaped(figure.caption));
    }
    bool sheets_;
};

/// Whether the first sheet can be one page, with pictures that are no smaller than can be judged.
bool fit_on_a_page(const std::vector<std::string>& reasons) {
    constexpr std::size_t kLine = 105, kMostLines = 13;
    std::size_t lines = 0;
    for (const auto& reason : reasons) lines += 1 + reason.size() / kLine;
    return lines <= kMostLines;
}

/// Name and value in two tables beside each other.
std::string two_tables(const ReportFacts& facts) {
    ReportFacts said;
    std::copy_if(facts.begin(), facts.end(), std::back_inserter(said),
                 [](const auto& fact) { return !fact.second.empty(); });
    const std::size_t half = (said.size() + 1) / 2;
    std::string html = "<div class=\"two\"><table>";
    for (std::size_t i = 0; i < said.size(); ++i)
        html += (i == half ? "</table><table>" : "") +
                fmt::format("<tr><td>{}</td><td>{}</td></tr>", xml_escaped(said[i].first), xml_escaped(said[i].second));
    return html + "</table></div>";
}

}  // namespace

std::string html_of(const Document& document) {
    std::string body;
    const Writer writer(document);
    for (const DocumentBlock& block : document.blocks) body += std::visit(writer, block);
    const std::string about = document.about.empty() ? "" : writer(DocumentText{document.about, Tone::quiet});
    if (!document.made_of_sheets)
        return html_page(document.title, document.verdict, document.facts, about + body, document.signed_by);
    const std::string head = "<h1>" + xml_escaped(document.title) + "</h1>" + verdict_as_list(document.verdict) +
                             about + two_tables(document.facts);
    return paper_page(
        document.title,
        fmt::format("<section class=\"sheet{}\">", fit_on_a_page(document.verdict.reasons) ? " fit" : "") + head +
            body + lines_to_sign(document.signed_by) + "</section>",
        document.foot);
}

}  // namespace planlight
