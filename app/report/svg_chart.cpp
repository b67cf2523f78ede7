#include "app/report/svg_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/report/html_page.h"

namespace planlight {
namespace {

constexpr double kLeft = 62, kRight = 16, kTop = 14, kBottom = 48;

/// 1, 2 or 5 times a power of ten.
double round_step(double range, int ticks) {
    const double raw = range / std::max(ticks, 1), power = std::pow(10, std::floor(std::log10(raw)));
    for (const double factor : {1.0, 2.0, 5.0})
        if (raw <= factor * power * 1.001) return factor * power;
    return 10 * power;
}

}  // namespace

SvgChart::SvgChart(Axis x, Axis y, int width, int height)
    : x_(std::move(x)), y_(std::move(y)), width_(width), height_(height) {}

double SvgChart::px(double x) const {
    return kLeft + (x - x_.from) / (x_.to - x_.from) * (width_ - kLeft - kRight);
}
double SvgChart::py(double y) const {
    return height_ - kBottom - (y - y_.from) / (y_.to - y_.from) * (height_ - kTop - kBottom);
}

void SvgChart::line(const Points& points, const std::string& colour, double thickness) {
    std::string way;
    for (const auto& [x, y] : points) way += fmt::format("{:.1f},{:.1f} ", px(x), py(y));
    drawn_ += fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"/>", way, colour,
                          thickness);
}

void SvgChart::dots(const Points& points, const std::string& colour, const std::vector<double>& sigma) {
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double x = px(points[i].first);
        if (i < sigma.size())
            drawn_ += fmt::format("<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{2:.1f}\" stroke=\"{3}\"/>",
                                  x, py(std::max(y_.from, points[i].second - sigma[i])),
                                  py(std::min(y_.to, points[i].second + sigma[i])), colour);
        drawn_ +=
            fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.5\" fill=\"{}\"/>", x, py(points[i].second), colour);
    }
}

void SvgChart::bar(double from, double to, double height, const std::string& colour) {
    drawn_ += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\"/>", px(from),
                          py(height), std::max(1.0, px(to) - px(from) - 1), py(y_.from) - py(height), colour);
}

void SvgChart::mark(double x, const std::string& words, const std::string& colour, int row) {
    const bool right = px(x) > 0.75 * width_;
    const double y = kTop + 14 + 18 * row;
    drawn_ += fmt::format(
        "<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{2:.1f}\" stroke=\"{3}\" stroke-dasharray=\"5 4\" "
        "stroke-width=\"2\"/>"
        "<text x=\"{4:.1f}\" y=\"{5:.1f}\" fill=\"{3}\" text-anchor=\"{6}\">{7}</text>",
        px(x), kTop, py(y_.from), colour, px(x) + (right ? -6 : 6), y, right ? "end" : "start", xml_escaped(words));
}

std::string SvgChart::text() const {
    std::string svg = fmt::format(
        "<svg viewBox=\"0 0 {0} {1}\" width=\"100%\" role=\"img\" style=\"background:#fff;font:14px Inter,'DejaVu "
        "Sans',sans-serif\">",
        width_, height_);
    const double step_x = round_step(x_.to - x_.from, x_.ticks), step_y = round_step(y_.to - y_.from, y_.ticks);
    for (double x = std::ceil(x_.from / step_x - 1e-9) * step_x; x <= x_.to + 1e-9 * step_x; x += step_x)
        svg += fmt::format(
            "<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{2:.1f}\" stroke=\"#d5dbe2\"/>"
            "<text x=\"{0:.1f}\" y=\"{3:.1f}\" fill=\"#44505c\" text-anchor=\"middle\">{4:g}</text>",
            px(x), py(y_.from), py(y_.to), height_ - kBottom + 18, std::abs(x) < 1e-9 * step_x ? 0.0 : x);
    for (double y = std::ceil(y_.from / step_y - 1e-9) * step_y; y <= y_.to + 1e-9 * step_y; y += step_y)
        svg += fmt::format(
            "<line x1=\"{1:.1f}\" x2=\"{2:.1f}\" y1=\"{0:.1f}\" y2=\"{0:.1f}\" stroke=\"#d5dbe2\"/>"
            "<text x=\"{3:.1f}\" y=\"{4:.1f}\" fill=\"#44505c\" text-anchor=\"end\">{5:g}</text>",
            py(y), kLeft, width_ - kRight, kLeft - 7, py(y) + 5, std::abs(y) < 1e-9 * step_y ? 0.0 : y);
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{}\" fill=\"#1b232c\" text-anchor=\"middle\">{}</text>",
                       (kLeft + width_ - kRight) / 2, height_ - 8, xml_escaped(x_.label));
    svg += fmt::format(
        "<text transform=\"translate(16 {:.1f}) rotate(-90)\" fill=\"#1b232c\" text-anchor=\"middle\">{}</text>",
        (kTop + height_ - kBottom) / 2.0, xml_escaped(y_.label));
    return svg + drawn_ + "</svg>";
}

}  // namespace planlight
