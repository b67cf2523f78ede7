#pragma once

#include <string>
#include <utility>
#include <vector>

namespace planlight {

/// A chart as SVG text for a page: axes with numbers, lines, points, bars, marked places. In the page's colours.
class SvgChart {
public:
    struct Axis {
        double from = 0, to = 1;
        std::string label;  ///< with its unit
        int ticks = 5;      ///< about so many
    };
    using Points = std::vector<std::pair<double, double>>;

    SvgChart(Axis x, Axis y, int width = 560, int height = 320);

    void line(const Points& points, const std::string& colour, double thickness = 2);
    /// `sigma` (of y) may be shorter: no bars for the rest.
    void dots(const Points& points, const std::string& colour, const std::vector<double>& sigma = {});
    void bar(double from, double to, double height, const std::string& colour);
    /// An upright line with words at its top; `row` 0 is the highest.
    void mark(double x, const std::string& words, const std::string& colour, int row = 0);

    std::string text() const;

private:
    double px(double x) const;
    double py(double y) const;
    Axis x_, y_;
    int width_, height_;
    std::string drawn_;
};

}  // namespace planlight
