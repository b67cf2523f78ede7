#include "app/report/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "planning_io/files/xml_text.h"

namespace planlight {
namespace {

constexpr double kLetters = 14;  ///< of a page, pixels; the margins are for these
constexpr double kLeft = 62, kRight = 16, kTop = 14, kBottom = 48;
constexpr Rgb kGrid{0xd5, 0xdb, 0xe2}, kNumbers{0x44, 0x50, 0x5c}, kLabels{0x1b, 0x23, 0x2c};

/// 1, 2 or 5 times a power of ten.
double round_step(double range, int ticks) {
    const double raw = range / std::max(ticks, 1), power = std::pow(10, std::floor(std::log10(raw)));
    for (const double factor : {1.0, 2.0, 5.0})
        if (raw <= factor * power * 1.001) return factor * power;
    return 10 * power;
}

/// The numbers that stand at an axis.
std::vector<double> ticks_of(const Chart::Axis& axis) {
    const double step = round_step(axis.to - axis.from, axis.ticks);
    std::vector<double> ticks;
    for (double at = std::ceil(axis.from / step - 1e-9) * step; at <= axis.to + 1e-9 * step; at += step)
        ticks.push_back(std::abs(at) < 1e-9 * step ? 0.0 : at);
    return ticks;
}

/// As SVG text.
class SvgCanvas : public ChartCanvas {
public:
    std::string text;

    void line(const Points& points, Rgb colour, double thickness, bool dashed) override {
        std::string way;
        for (const auto& [x, y] : points) way += fmt::format("{:.1f},{:.1f} ", x, y);
        text += fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"{}/>", way,
                            web_colour(colour), thickness, dashed ? " stroke-dasharray=\"5 4\"" : "");
    }
    void rectangle(double x, double y, double width, double height, Rgb colour) override {
        text += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\"/>", x, y,
                            width, height, web_colour(colour));
    }
    void dot(double x, double y, double radius, Rgb colour) override {
        text += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\" fill=\"{}\"/>", x, y, radius,
                            web_colour(colour));
    }
    void words(double x, double y, const std::string& words, Rgb colour, Anchor anchor, bool upwards) override {
        constexpr const char* kAnchors[] = {"start", "middle", "end"};
        text += fmt::format("<text transform=\"translate({:.1f} {:.1f}){}\" fill=\"{}\" text-anchor=\"{}\">{}</text>",
                            x, y, upwards ? " rotate(-90)" : "", web_colour(colour),
                            kAnchors[static_cast<std::size_t>(anchor)], xml_escaped(words));
    }
};

}  // namespace

std::string web_colour(const Rgb& c) {
    return fmt::format("#{:02x}{:02x}{:02x}", c[0], c[1], c[2]);
}

Chart::Chart(Axis x, Axis y, int width, int height)
    : x_(std::move(x)), y_(std::move(y)), width_(width), height_(height) {}

void Chart::line(const Points& points, Rgb colour, double thickness) {
    drawn_.emplace_back(Line{points, colour, thickness});
}

void Chart::dots(const Points& points, Rgb colour, const std::vector<double>& sigma) {
    drawn_.emplace_back(Dots{points, colour, sigma});
}

void Chart::bar(double from, double to, double height, Rgb colour) {
    drawn_.emplace_back(Bar{from, to, height, colour});
}

void Chart::mark(double x, const std::string& words, Rgb colour, int row) {
    drawn_.emplace_back(Mark{x, words, colour, row});
}

/// A chart on a canvas: where its numbers lie there, and how each of its things is drawn.
class Chart::Place {
public:
    Place(const Chart& chart, ChartCanvas& canvas, double width, double height, double letters)
        : of_(chart), canvas_(canvas), width_(width), height_(height), unit_(letters / kLetters) {}

    void axes() {
        const double foot = py(of_.y_.from), left = kLeft * unit_, right = width_ - kRight * unit_;
        for (const double x : ticks_of(of_.x_)) {
            canvas_.line({{px(x), foot}, {px(x), kTop * unit_}}, kGrid, unit_, false);
            canvas_.words(px(x), height_ - (kBottom - 18) * unit_, fmt::format("{:g}", x), kNumbers,
                          ChartCanvas::Anchor::middle, false);
        }
        for (const double y : ticks_of(of_.y_)) {
            canvas_.line({{left, py(y)}, {right, py(y)}}, kGrid, unit_, false);
            canvas_.words(left - 7 * unit_, py(y) + 5 * unit_, fmt::format("{:g}", y), kNumbers,
                          ChartCanvas::Anchor::end, false);
        }
        canvas_.words((left + right) / 2, height_ - 8 * unit_, of_.x_.label, kLabels, ChartCanvas::Anchor::middle,
                      false);
        canvas_.words(16 * unit_, (kTop * unit_ + height_ - kBottom * unit_) / 2, of_.y_.label, kLabels,
                      ChartCanvas::Anchor::middle, true);
    }
    void operator()(const Line& line) {
        Points points;
        for (const auto& [x, y] : line.points) points.emplace_back(px(x), py(y));
        canvas_.line(points, line.colour, line.thickness * unit_, false);
    }
    void operator()(const Dots& dots) {
        for (std::size_t i = 0; i < dots.points.size(); ++i) {
            const auto& [x, y] = dots.points[i];
            if (i < dots.sigma.size())
                canvas_.line({{px(x), py(std::max(of_.y_.from, y - dots.sigma[i]))},
                              {px(x), py(std::min(of_.y_.to, y + dots.sigma[i]))}},
                             dots.colour, unit_, false);
            canvas_.dot(px(x), py(y), 3.5 * unit_, dots.colour);
        }
    }
    void operator()(const Bar& bar) {
        canvas_.rectangle(px(bar.from), py(bar.height), std::max(unit_, px(bar.to) - px(bar.from) - unit_),
                          py(of_.y_.from) - py(bar.height), bar.colour);
    }
    void operator()(const Mark& mark) {
        const bool right = px(mark.x) > 0.75 * width_;
        canvas_.line({{px(mark.x), kTop * unit_}, {px(mark.x), py(of_.y_.from)}}, mark.colour, 2 * unit_, true);
        canvas_.words(px(mark.x) + (right ? -6 : 6) * unit_, (kTop + 14 + 18 * mark.row) * unit_, mark.words,
                      mark.colour, right ? ChartCanvas::Anchor::end : ChartCanvas::Anchor::start, false);
    }

private:
    double px(double x) const {
        return kLeft * unit_ + (x - of_.x_.from) / (of_.x_.to - of_.x_.from) * (width_ - (kLeft + kRight) * unit_);
    }
    double py(double y) const {
        return height_ - kBottom * unit_ -
               (y - of_.y_.from) / (of_.y_.to - of_.y_.from) * (height_ - (kTop + kBottom) * unit_);
    }
    const Chart& of_;
    ChartCanvas& canvas_;
    double width_, height_, unit_;
};

void Chart::draw(ChartCanvas& canvas, double width, double height, double letters) const {
    Place place(*this, canvas, width, height, letters);
    place.axes();
    for (const auto& one : drawn_) std::visit(place, one);
}

std::string Chart::svg() const {
    SvgCanvas canvas;
    draw(canvas, width_, height_, kLetters);
    return fmt::format(
        "<svg viewBox=\"0 0 {} {}\" width=\"100%\" role=\"img\" style=\"background:#fff;font:14px Inter,'DejaVu "
        "Sans',sans-serif\">{}</svg>",
        width_, height_, canvas.text);
}

}  // namespace planlight
