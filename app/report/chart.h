#pragma once

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "planning_io/types/image.h"

namespace planlight {

/// What a chart is drawn on. Lengths in its own unit, x to the right, y downwards.
class ChartCanvas {
public:
    enum class Anchor { start, middle, end };
    using Points = std::vector<std::pair<double, double>>;

    virtual ~ChartCanvas() = default;
    virtual void line(const Points& points, Rgb colour, double thickness, bool dashed) = 0;
    virtual void rectangle(double x, double y, double width, double height, Rgb colour) = 0;
    virtual void dot(double x, double y, double radius, Rgb colour) = 0;
    /// On one line that ends, begins or has its middle at that point; `upwards`: read from the bottom to the top.
    virtual void words(double x, double y, const std::string& text, Rgb colour, Anchor anchor, bool upwards) = 0;
};

/// A chart of a report: axes with numbers, lines, points, bars, marked places. In the page's colours, and the same on
/// screen and on paper.
class Chart {
public:
    struct Axis {
        double from = 0, to = 1;
        std::string label;  ///< with its unit
        int ticks = 5;      ///< about so many
    };
    using Points = ChartCanvas::Points;

    Chart(Axis x, Axis y, int width = 560, int height = 320);

    void line(const Points& points, Rgb colour, double thickness = 2);
    /// `sigma` (of y) may be shorter: no bars for the rest.
    void dots(const Points& points, Rgb colour, const std::vector<double>& sigma = {});
    void bar(double from, double to, double height, Rgb colour);
    /// An upright line with words at its top; `row` 0 is the highest.
    void mark(double x, const std::string& words, Rgb colour, int row = 0);

    int width() const { return width_; }
    int height() const { return height_; }

    /// On `width` x `height` of the canvas with letters of that size. As drawn for a page they have 14 of its pixels.
    void draw(ChartCanvas& canvas, double width, double height, double letters) const;
    /// For a page, as wide as there is room.
    std::string svg() const;

private:
    struct Line {
        Points points;
        Rgb colour;
        double thickness;
    };
    struct Dots {
        Points points;
        Rgb colour;
        std::vector<double> sigma;
    };
    struct Bar {
        double from, to, height;
        Rgb colour;
    };
    struct Mark {
        double x;
        std::string words;
        Rgb colour;
        int row;
    };
    class Place;
    Axis x_, y_;
    int width_, height_;
    std::vector<std::variant<Line, Dots, Bar, Mark>> drawn_;
};

/// "#0b8a4c".
std::string web_colour(const Rgb& colour);

}  // namespace planlight
