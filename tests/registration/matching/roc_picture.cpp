#include "tests/registration/matching/roc_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace planlight::test {
namespace {

const cv::Rect kPlot(110, 70, 940, 620);
const cv::Scalar kInk(40, 40, 40), kFaint(215, 215, 215);

double share_from(const std::vector<double>& sorted, double limit) {
    const auto at = std::lower_bound(sorted.begin(), sorted.end(), limit);
    return sorted.empty() ? 0 : static_cast<double>(sorted.end() - at) / static_cast<double>(sorted.size());
}

/// Logarithmic from the least share that so many trials can show; a place of its own for none.
double across(double wrong_share, double least) {
    const double decades = std::log10(1 / least);
    return wrong_share < 0.999 * least ? 0 : 0.08 + 0.92 * (1 - std::log10(1 / wrong_share) / decades);
}

cv::Point at(double x, double y) {
    return {kPlot.x + static_cast<int>(std::lround(x * kPlot.width)),
            kPlot.y + static_cast<int>(std::lround((1 - y) * kPlot.height))};
}

void write_text(cv::Mat& picture, const std::string& text, cv::Point where, double size = 0.5) {
    cv::putText(picture, text, where, cv::FONT_HERSHEY_SIMPLEX, size, kInk, 1, cv::LINE_AA);
}

void draw_axes(cv::Mat& picture, double least, const std::string& title) {
    for (int i = 0; i <= 10; ++i) {
        const double y = 0.1 * i;
        cv::line(picture, at(0, y), at(1, y), kFaint, 1);
        write_text(picture, fmt::format("{:.0f} %", 100 * y), at(0, y) + cv::Point(-60, 5));
    }
    write_text(picture, "none", at(0, 0) + cv::Point(-16, 24));
    for (double share = 1; share > 0.999 * least; share /= 10) {
        cv::line(picture, at(across(share, least), 0), at(across(share, least), 1), kFaint, 1);
        write_text(picture, fmt::format("{:g} %", 100 * share), at(across(share, least), 0) + cv::Point(-20, 24));
    }
    cv::rectangle(picture, kPlot, kInk, 1);
    write_text(picture, title, {kPlot.x, 40}, 0.65);
    write_text(picture, "wrong ones accepted, share of those that must not be (logarithmic)",
               {kPlot.x + 200, kPlot.y + kPlot.height + 60}, 0.55);
    write_text(picture, "right ones accepted", {kPlot.x - 100, kPlot.y - 12}, 0.55);
}

}  // namespace

void write_roc(const std::vector<RocCurve>& curves, const std::vector<RocPoint>& points, const std::string& title,
               const std::filesystem::path& file) {
    const std::vector<cv::Scalar> colours{{180, 90, 20}, {30, 120, 220},  {60, 150, 40}, {150, 40, 150},
                                          {60, 60, 200}, {120, 120, 120}, {0, 190, 190}};
    cv::Mat picture(800, 1480, CV_8UC3, cv::Scalar(255, 255, 255));
    std::size_t most = 10;
    for (const RocCurve& curve : curves) most = std::max(most, curve.wrong.size());
    const double least = 1 / static_cast<double>(most);
    draw_axes(picture, least, title);
    for (std::size_t c = 0; c < curves.size(); ++c) {
        std::vector<double> right = curves[c].right, wrong = curves[c].wrong, limits = right;
        limits.insert(limits.end(), wrong.begin(), wrong.end());
        for (auto* values : {&right, &wrong, &limits}) std::sort(values->begin(), values->end());
        std::vector<cv::Point> line;
        for (auto limit = limits.rbegin(); limit != limits.rend(); ++limit)
            line.push_back(at(across(share_from(wrong, *limit), least), share_from(right, *limit)));
        const cv::Scalar& colour = colours[c % colours.size()];
        cv::polylines(picture, line, false, colour, 2, cv::LINE_AA);
    }
    for (std::size_t c = 0; c < curves.size(); ++c) {
        const cv::Point key = at(1.03, 0.9 - 0.06 * static_cast<double>(c));  // beside the axes, over no curve
        cv::line(picture, key, key + cv::Point(30, 0), colours[c % colours.size()], 3);
        write_text(picture, fmt::format("{} (area {:.4f})", curves[c].name, area_under(curves[c])),
                   key + cv::Point(40, 5));
    }
    for (const RocPoint& point : points) {
        const cv::Point where = at(across(point.wrong_share, least), point.right_share);
        cv::circle(picture, where, 8, kInk, 2, cv::LINE_AA);
        write_text(picture, point.name, where + cv::Point(14, 22));
    }
    if (!cv::imwrite(file.string(), picture, {cv::IMWRITE_PNG_COMPRESSION, 9}))
        throw std::runtime_error("cannot write " + file.string());
}

double area_under(const RocCurve& curve) {
    std::vector<double> wrong = curve.wrong;
    std::sort(wrong.begin(), wrong.end());
    double sum = 0;
    for (const double r : curve.right) {
        const auto below = std::lower_bound(wrong.begin(), wrong.end(), r) - wrong.begin();
        const auto up_to = std::upper_bound(wrong.begin(), wrong.end(), r) - wrong.begin();
        sum += 0.5 * static_cast<double>(below + up_to);
    }
    const double pairs = static_cast<double>(curve.right.size()) * static_cast<double>(wrong.size());
    return pairs > 0 ? sum / pairs : 0;
}

double accepted_at(const RocCurve& curve, double wrong_share) {
    if (curve.wrong.empty() || curve.right.empty()) return 0;
    std::vector<double> wrong = curve.wrong;
    std::sort(wrong.begin(), wrong.end(), std::greater<>());
    const double limit =
        wrong[std::min(wrong.size() - 1, static_cast<std::size_t>(wrong_share * static_cast<double>(wrong.size())))];
    const auto above = std::count_if(curve.right.begin(), curve.right.end(), [&](double r) { return r > limit; });
    return static_cast<double>(above) / static_cast<double>(curve.right.size());
}

}  // namespace planlight::test
