#include "registration/scan/code_map.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace planlight {
namespace {

constexpr int kReach = 2;            // 5 x 5 neighbours
constexpr int kWhole = (2 * kReach + 1) * (2 * kReach + 1);
constexpr int kMinNeighbours = 12;   // about half of them
constexpr double kRoughness_px = 0.25;  // rms about the affine map that the surface's own curvature and texture may make
constexpr int kMaxSteps = 5;

/// Sums of a weighted affine fit, weights 0 or 1, about the centre's own code.
struct Sums {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
    Eigen::Vector2d c = Eigen::Vector2d::Zero(), cx = c, cy = c;
    double cc = 0;
};

Sums sum_neighbours(const DecodedView& view, int x, int y, const Eigen::Vector2d& centre, double max_jump_px) {
    Sums s;
    const bool rows = !view.row.empty();
    for (int dy = -kReach; dy <= kReach; ++dy) {
        if (y + dy < 0 || y + dy >= view.height) continue;
        for (int dx = -kReach; dx <= kReach; ++dx) {
            if (x + dx < 0 || x + dx >= view.width) continue;
            const std::size_t i = static_cast<std::size_t>(y + dy) * static_cast<std::size_t>(view.width) +
                                  static_cast<std::size_t>(x + dx);
            const Eigen::Vector2d d(view.column[i] - centre.x(), rows ? view.row[i] - centre.y() : 0.0);
            if (!(std::abs(d.x()) <= max_jump_px && std::abs(d.y()) <= max_jump_px)) continue;  // NaN fails too
            s.n += 1;
            s.x += dx;
            s.y += dy;
            s.xx += dx * dx;
            s.xy += dx * dy;
            s.yy += dy * dy;
            s.c += d;
            s.cx += dx * d;
            s.cy += dy * d;
            s.cc += d.squaredNorm();
        }
    }
    return s;
}

}  // namespace

std::optional<LocalCode> local_code(const DecodedView& view, int x, int y) {
    const std::size_t i = static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width) + static_cast<std::size_t>(x);
    if (std::isnan(view.column[i])) return std::nullopt;
    const bool rows = !view.row.empty();
    const Eigen::Vector2d centre(view.column[i], rows ? view.row[i] : 0.0);
    // A camera pixel spans a few projector pixels at most; a jump of more is another surface, not a slope.
    constexpr double kMaxJump_px = 12;
    const Sums s = sum_neighbours(view, x, y, centre, kMaxJump_px);
    if (s.n < kMinNeighbours) return std::nullopt;
    Eigen::Matrix3d A;
    A << s.n, s.x, s.y, s.x, s.xx, s.xy, s.y, s.xy, s.yy;
    Eigen::Matrix<double, 3, 2> b;
    b << s.c.transpose(), s.cx.transpose(), s.cy.transpose();
    bool invertible = false;
    Eigen::Matrix3d inverse;
    A.computeInverseWithCheck(inverse, invertible, 1e-6);
    if (!invertible) return std::nullopt;
    const Eigen::Matrix<double, 3, 2> fit = inverse * b;
    const double sigma = view.sigma_px[i];
    const double residual = s.cc - (fit.array() * b.array()).sum();
    const double directions = rows ? 2 : 1;
    const double allowed = kRoughness_px * kRoughness_px + 9 * sigma * sigma;
    if (residual > directions * (s.n - 3) * allowed) return std::nullopt;
    if (fit.row(0).squaredNorm() > 9 * directions * allowed) return std::nullopt;  // the pixel itself stands off
    return LocalCode{centre + fit.row(0).transpose(), fit.bottomRows<2>().transpose(), s.n > kWhole - 0.5,
                     sigma * std::sqrt(inverse(0, 0))};
}

CodeIndex::CodeIndex(const DecodedView& view, int projector_width, int projector_height)
    : view_(view), width_(projector_width), height_(projector_height),
      pixel_of_(static_cast<std::size_t>(projector_width) * static_cast<std::size_t>(projector_height), -1) {
    for (std::size_t i = 0; i < view.column.size(); ++i) {
        if (std::isnan(view.column[i])) continue;
        const long c = std::lround(view.column[i]), r = std::lround(view.row[i]);
        if (c < 0 || r < 0 || c >= width_ || r >= height_) continue;
        pixel_of_[static_cast<std::size_t>(r) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(c)] =
            static_cast<std::int32_t>(i);
    }
}

std::int32_t CodeIndex::candidate(const Eigen::Vector2d& code) const {
    const int c = static_cast<int>(std::lround(code.x())), r = static_cast<int>(std::lround(code.y()));
    constexpr int kRings = 3;  // the view may see the projector's pixels coarsely
    for (int ring = 0; ring <= kRings; ++ring)
        for (int dr = -ring; dr <= ring; ++dr)
            for (int dc = -ring; dc <= ring; ++dc) {
                if (std::max(std::abs(dr), std::abs(dc)) != ring) continue;
                if (c + dc < 0 || r + dr < 0 || c + dc >= width_ || r + dr >= height_) continue;
                const std::int32_t pixel =
                    pixel_of_[static_cast<std::size_t>(r + dr) * static_cast<std::size_t>(width_) +
                              static_cast<std::size_t>(c + dc)];
                if (pixel >= 0) return pixel;
            }
    return -1;
}

std::optional<CodeIndex::Match> CodeIndex::find(const Eigen::Vector2d& code) const {
    const std::int32_t start = candidate(code);
    if (start < 0) return std::nullopt;
    int x = start % view_.width, y = start / view_.width;
    for (int step = 0; step < kMaxSteps; ++step) {
        const auto local = local_code(view_, x, y);
        if (!local) return std::nullopt;
        // The view's rows and columns must both be resolved there, or the place is not determined.
        const double determinant = local->by_pixel.determinant();
        if (std::abs(determinant) < 1e-3 * local->by_pixel.squaredNorm()) return std::nullopt;
        const Eigen::Vector2d d = local->by_pixel.inverse() * (code - local->code);
        if (d.cwiseAbs().maxCoeff() <= 0.75) return Match{Eigen::Vector2d(x, y) + d, *local};
        if (d.cwiseAbs().maxCoeff() > 12) return std::nullopt;
        x += static_cast<int>(std::lround(d.x()));
        y += static_cast<int>(std::lround(d.y()));
        if (x < 0 || y < 0 || x >= view_.width || y >= view_.height) return std::nullopt;
    }
    return std::nullopt;
}

}  // namespace planlight
