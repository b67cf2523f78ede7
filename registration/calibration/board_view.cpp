#include "registration/calibration/board_view.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "planning_io/types/statistics.h"

namespace planlight {
namespace {

using Eigen::Vector2d;

/// How far to either side of an edge is looked: squares. A ChArUco marker begins an eighth of a square off.
constexpr double kBeside = 0.115;
constexpr int kSaturated = 254;

std::optional<double> grey_at(const GrayImage& picture, const Vector2d& p) {
    const int x = static_cast<int>(std::floor(p.x())), y = static_cast<int>(std::floor(p.y()));
    if (x < 0 || y < 0 || x + 1 >= picture.width || y + 1 >= picture.height) return std::nullopt;
    const double a = p.x() - x, b = p.y() - y;
    return (1 - b) * ((1 - a) * picture.at(x, y) + a * picture.at(x + 1, y)) +
           b * ((1 - a) * picture.at(x, y + 1) + a * picture.at(x + 1, y + 1));
}

struct Edge {
    double paper = 0, ink = 0, steepest = 0;  ///< grey, grey, grey a pixel
};

/// Across the middle of the edge from `a` to `b`: mean of a few lines, so that noise makes no steep step.
std::optional<Edge> edge_between(const GrayImage& picture, const Vector2d& a, const Vector2d& b) {
    const Vector2d along = b - a;
    const double length = along.norm();
    if (length < 8) return std::nullopt;
    const Vector2d across = Vector2d(-along.y(), along.x()) / length;
    const double reach = std::max(2.0, kBeside * length);
    constexpr int kLines = 9;
    constexpr double kStep_px = 0.5;
    std::vector<double> profile;
    for (double s = -reach; s <= reach + 1e-9; s += kStep_px) {
        double sum = 0;
        for (int i = 0; i < kLines; ++i) {
            const auto grey = grey_at(picture, a + (0.3 + 0.4 * i / (kLines - 1)) * along + s * across);
            if (!grey) return std::nullopt;
            sum += *grey;
        }
        profile.push_back(sum / kLines);
    }
    Edge edge{*std::max_element(profile.begin(), profile.end()), *std::min_element(profile.begin(), profile.end())};
    for (std::size_t i = 0; i + 2 < profile.size(); ++i)
        edge.steepest = std::max(edge.steepest, std::abs(profile[i + 2] - profile[i]) / (2 * kStep_px));
    return edge;
}

}  // namespace

BoardView look_at_board(const GrayImage& picture, const BoardSpec& board) {
    BoardView view;
    view.width = picture.width;
    view.height = picture.height;
    view.corners = find_board(picture, board);
    if (!spans_a_plane(view.corners, board)) {
        view.corners = {};
        return view;
    }
    std::vector<double> paper, contrast, blur;
    std::size_t saturated = 0;
    for (std::size_t i = 0; i + 1 < view.corners.size(); ++i) {
        const int id = view.corners.ids[i];
        const bool neighbours = view.corners.ids[i + 1] == id + 1 && (id + 1) % board.corners_across() != 0;
        if (!neighbours) continue;
        const auto edge = edge_between(picture, view.corners.pixels[i], view.corners.pixels[i + 1]);
        if (!edge) continue;
        paper.push_back(edge->paper);
        contrast.push_back(edge->paper - edge->ink);
        saturated += edge->paper >= kSaturated;
        // The steepest slope of a step of that height, blurred by a Gaussian.
        if (edge->steepest > 0)
            blur.push_back((edge->paper - edge->ink) / (std::sqrt(2 * std::numbers::pi) * edge->steepest));
    }
    if (paper.empty()) return view;
    view.saturated_share = static_cast<double>(saturated) / static_cast<double>(paper.size());
    view.paper_grey = median(paper);
    view.contrast_grey = median(contrast);
    if (!blur.empty()) view.blur_px = median(blur);
    return view;
}

}  // namespace planlight
