#include "registration/scan/check/panel_ends.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "planning_io/types/statistics.h"

namespace planlight {
namespace {

/// A decoded pixel beside one that is not.
struct End {
    double code = 0;
    int x = 0, y = 0;
    bool lit = false;       ///< the one beside it has light; else the room lights it alone
    double light_grey = 0;  ///< of the projector, on the decoded one
};

std::vector<End> ends_of(const DecodedView& view, const LargeArray<float>& code, const GrayImage& white,
                         const GrayImage& black) {
    constexpr int kBeside = 4;  // pixels: beyond the blur of an edge
    constexpr int kLeastRoom_grey = 8;
    constexpr double kUnlit = 0.15, kLit = 0.6, kRoomAlike = 0.6;
    std::vector<End> ends;
    for (int y = kBeside; y < view.height - kBeside; ++y)
        for (int x = kBeside; x < view.width - kBeside; ++x) {
            const std::size_t i = white.index(x, y);
            if (std::isnan(code[i])) continue;
            for (const auto& [dx, dy] : {std::array{kBeside, 0}, {-kBeside, 0}, {0, kBeside}, {0, -kBeside}}) {
                const std::size_t k = white.index(x + dx, y + dy);
                if (!std::isnan(code[k])) continue;
                const double here = white.pixels[i] - black.pixels[i], there = white.pixels[k] - black.pixels[k];
                if (there >= kLit * here)
                    ends.push_back({code[i], x, y, true, here});
                else if (there <= kUnlit * here && black.pixels[i] >= kLeastRoom_grey &&
                         black.pixels[k] >= kRoomAlike * black.pixels[i])
                    ends.push_back({code[i], x, y, false, here});
            }
        }
    return ends;
}

/// Ends between two codes, lit or not.
struct Edge {
    std::vector<double> x, y, light_grey;
    double count() const { return static_cast<double>(x.size()); }
    /// Enough of them, along a good part of the camera's picture.
    bool is_long(const DecodedView& view) const {
        constexpr double kFew = 60, kLong = 0.05;
        const auto reach = [](const std::vector<double>& v) { return quantile(v, 0.95) - quantile(v, 0.05); };
        return count() >= kFew && std::hypot(reach(x), reach(y)) > kLong * std::max(view.width, view.height);
    }
};

Edge edge_between(const std::vector<End>& ends, double from, double to, bool lit) {
    Edge edge;
    for (const End& end : ends)
        if (end.lit == lit && end.code >= from && end.code <= to)
            edge.x.push_back(end.x), edge.y.push_back(end.y), edge.light_grey.push_back(end.light_grey);
    return edge;
}

/// Whether the light at an edge is about as bright as just inside of it: that of a picture's end is. A head turns away
/// from the light, and what lies farthest out on it is dim.
bool is_bright(const Edge& edge, const LargeArray<float>& code, const GrayImage& white, const GrayImage& black,
               double last) {
    constexpr double kFrom_px = 40, kTo_px = 10, kAsBright = 0.7;
    std::vector<double> inside_grey;
    for (std::size_t i = 0; i < code.size(); ++i)
        if (code[i] >= last - kFrom_px && code[i] <= last - kTo_px)
            inside_grey.push_back(white.pixels[i] - black.pixels[i]);
    return !inside_grey.empty() && quantile(edge.light_grey, 0.5) >= kAsBright * quantile(inside_grey, 0.5);
}

/// One in a thousand decoded pixels has a higher code; 0 where few are decoded.
double last_code(const LargeArray<float>& code, int size) {
    constexpr std::size_t kFew = 7000, kAbove = 1000;
    std::vector<std::size_t> pixels(static_cast<std::size_t>(size) + 1, 0);
    std::size_t decoded = 0;
    for (const float c : code) {
        if (std::isnan(c)) continue;
        ++pixels[static_cast<std::size_t>(std::clamp(c + 0.5F, 0.F, static_cast<float>(size)))];
        ++decoded;
    }
    if (decoded < kFew) return 0;
    std::size_t above = 0, last = pixels.size();
    while (above * kAbove <= decoded) above += pixels[--last];
    return static_cast<double>(last);
}

/// What is wrong with one direction; empty: nothing.
std::optional<SequenceProblem> problem_of(const DecodedView& view, const LargeArray<float>& code,
                                          const GrayImage& white, const GrayImage& black, int size, const char* what) {
    constexpr double kNear_px = 3, kZone_px = 20, kMostCropped = 0.05, kStraight = 0.85;
    const double last = last_code(code, size);
    if (last == 0) return std::nullopt;
    const bool early = last < (1 - kMostCropped) * size;
    if (!early && last < size - kNear_px - 1) return std::nullopt;
    const std::vector<End> ends = ends_of(view, code, white, black);
    if (!early) {
        const Edge lit = edge_between(ends, size - 1 - kNear_px, size, true);
        const Edge dark = edge_between(ends, size - 1 - kNear_px, size, false);
        if (!lit.is_long(view) || lit.count() < 3 * dark.count()) return std::nullopt;
        return SequenceProblem{0, fmt::format("light is seen beyond the code's last {} ({})", what, size),
                               lit.count() / static_cast<double>(ends.size()), SequenceProblem::Cause::fringes};
    }
    const Edge near = edge_between(ends, last - kNear_px, last + kNear_px, false);
    const Edge zone = edge_between(ends, last - kZone_px, last + kZone_px, false);
    if (!near.is_long(view) || near.count() < kStraight * zone.count() || !is_bright(near, code, white, black, last))
        return std::nullopt;
    return SequenceProblem{
        0,
        fmt::format("the light ends in a straight edge at {} {:.0f} by the code, and the picture has {}", what, last,
                    size),
        near.count() / static_cast<double>(ends.size()), SequenceProblem::Cause::fringes};
}

}  // namespace

std::optional<SequenceProblem> check_panel_ends(const DecodedView& view, const GrayImage& white, const GrayImage& black,
                                                const StripeSettings& stripes) {
    if (stripes.begins_at_column != 0 || stripes.begins_at_row != 0) return std::nullopt;
    if (auto problem = problem_of(view, view.column, white, black, stripes.width, "column")) return problem;
    if (view.row.empty()) return std::nullopt;
    return problem_of(view, view.row, white, black, stripes.height, "row");
}

}  // namespace planlight
