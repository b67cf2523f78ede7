#include "registration/scan/code_map.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstring>

#include "registration/processor_clones.h"

namespace planlight {
namespace {

constexpr int kReach = 2;            // 5 x 5 neighbours
constexpr int kWhole = (2 * kReach + 1) * (2 * kReach + 1);
constexpr int kMinNeighbours = 12;   // about half of them
constexpr double kRoughness_px = 0.25;  // rms about the affine map that the surface's own curvature and texture may make
// A camera pixel spans a few projector pixels at most; a jump of more is another surface, not a slope.
constexpr double kMaxJump_px = 12;
constexpr int kMaxSteps = 5;
constexpr int kCell_px = 4, kRings = 2;  // of the index: a view may see the projector's pixels coarsely
constexpr double kMaxWay_px = 16;        // from where the search begins to what it finds

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

/// Sums over the whole 5 x 5 neighbourhood, about the centre's own code.
struct WholeSums {
    float c[2] = {}, cx[2] = {}, cy[2] = {}, cc = 0;
};

/// False when a neighbour is not decoded or jumps. Five rows of eight lanes, of which five count; `column` and `row` point
/// at the centre pixel, with three more floats to read behind the last neighbour. Null `row`: columns only.
PLANLIGHT_CLONES bool sum_whole(const float* column, const float* row, std::ptrdiff_t width, float max_jump_px, WholeSums& sums) {
    typedef float Lanes __attribute__((vector_size(32)));
    typedef std::int32_t Mask __attribute__((vector_size(32)));
    const Mask use = {-1, -1, -1, -1, -1, 0, 0, 0}, size_only = Mask{} + 0x7fffffff;
    const Lanes dx = {-2, -1, 0, 1, 2, 0, 0, 0}, limit = Lanes{} + max_jump_px;
    Mask bad = {};
    Lanes squares = {};
    for (int direction = 0; direction < (row ? 2 : 1); ++direction) {
        const float* code = direction == 0 ? column : row;
        Lanes sum = {}, by_y = {};
        for (int dy = -kReach; dy <= kReach; ++dy) {
            Lanes d;
            std::memcpy(&d, code + dy * width - kReach, sizeof d);
            d = (Lanes)((Mask)(d - *code) & use);
            bad |= ~((Lanes)((Mask)d & size_only) <= limit);  // NaN as well
            sum += d;
            by_y += static_cast<float>(dy) * d;
            squares += d * d;
        }
        for (int lane = 0; lane < 5; ++lane) {
            sums.c[direction] += sum[lane];
            sums.cx[direction] += dx[lane] * sum[lane];
            sums.cy[direction] += by_y[lane];
        }
    }
    int any = 0;
    for (int lane = 0; lane < 5; ++lane) {
        sums.cc += squares[lane];
        any |= bad[lane];
    }
    return any == 0;
}

/// What is left after the fit must be roughness and noise, and the pixel itself must not stand off.
bool smooth(double residual, double freedom, double own_squared, double sigma_px, double directions) {
    const double allowed = kRoughness_px * kRoughness_px + 9 * sigma_px * sigma_px;
    return residual <= directions * freedom * allowed && own_squared <= 9 * directions * allowed;
}

/// The fit over all 25 neighbours: sums of x, y and x y vanish, those of x^2 and y^2 are 50.
std::optional<LocalCode> fit_whole(const WholeSums& s, const Eigen::Vector2d& centre, double sigma_px, double directions) {
    const Eigen::Vector2d c(s.c[0], s.c[1]), cx(s.cx[0], s.cx[1]), cy(s.cy[0], s.cy[1]);
    const double residual = s.cc - c.squaredNorm() / kWhole - (cx.squaredNorm() + cy.squaredNorm()) / 50;
    if (!smooth(residual, kWhole - 3, c.squaredNorm() / (kWhole * kWhole), sigma_px, directions)) return std::nullopt;
    LocalCode local{centre + c / kWhole, {}, true, sigma_px / (2 * kReach + 1)};
    local.by_pixel << cx / 50, cy / 50;
    return local;
}

}  // namespace

std::optional<LocalCode> local_code(const DecodedView& view, int x, int y) {
    const std::size_t i = static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width) + static_cast<std::size_t>(x);
    if (std::isnan(view.column[i])) return std::nullopt;
    const bool rows = !view.row.empty();
    const double directions = rows ? 2 : 1;
    const Eigen::Vector2d centre(view.column[i], rows ? view.row[i] : 0.0);
    if (x >= kReach && y >= kReach && x + kReach < view.width && y + kReach + 1 < view.height && view.width > 8) {
        WholeSums whole;
        if (sum_whole(&view.column[i], rows ? &view.row[i] : nullptr, view.width, static_cast<float>(kMaxJump_px), whole))
            return fit_whole(whole, centre, view.sigma_px[i], directions);
    }
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
    const double residual = s.cc - (fit.array() * b.array()).sum();
    if (!smooth(residual, s.n - 3, fit.row(0).squaredNorm(), view.sigma_px[i], directions)) return std::nullopt;
    return LocalCode{centre + fit.row(0).transpose(), fit.bottomRows<2>().transpose(), s.n > kWhole - 0.5,
                     view.sigma_px[i] * std::sqrt(inverse(0, 0))};
}

CodeIndex::CodeIndex(const DecodedView& view, int projector_width, int projector_height)
    : view_(view), columns_((projector_width + kCell_px - 1) / kCell_px), rows_((projector_height + kCell_px - 1) / kCell_px),
      pixel_in_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), -1) {
    constexpr float kByCell = 1.0f / kCell_px;
    // Every second pixel of every second line: a piece of code without one of them is too small to be fitted.
    for (int y = 0; y < view.height; y += 2) {
        const std::size_t line = static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width);
        for (int x = 0; x < view.width; x += 2) {
            const std::size_t i = line + static_cast<std::size_t>(x);
            if (!(view.column[i] >= -0.5f && view.row[i] >= -0.5f)) continue;  // NaN as well
            const int c = static_cast<int>((view.column[i] + 0.5f) * kByCell),
                      r = static_cast<int>((view.row[i] + 0.5f) * kByCell);
            if (c >= columns_ || r >= rows_) continue;
            pixel_in_[static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(c)] =
                static_cast<std::int32_t>(i);
        }
    }
}

std::optional<CodeIndex::Match> CodeIndex::find(const Eigen::Vector2d& code) const {
    if (!(code.minCoeff() > -kCell_px)) return std::nullopt;
    const int c = static_cast<int>((code.x() + 0.5) / kCell_px), r = static_cast<int>((code.y() + 0.5) / kCell_px);
    for (int ring = 0; ring <= kRings; ++ring)
        for (int y = std::max(0, r - ring); y <= std::min(rows_ - 1, r + ring); ++y)
            for (int x = std::max(0, c - ring); x <= std::min(columns_ - 1, c + ring); ++x) {
                if (std::max(std::abs(y - r), std::abs(x - c)) != ring) continue;
                const std::int32_t start =
                    pixel_in_[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(x)];
                if (start < 0) continue;
                if (const auto match = find_from(code, {start % view_.width, start / view_.width})) return match;
            }
    return std::nullopt;
}

std::optional<CodeIndex::Match> CodeIndex::find_from(const Eigen::Vector2d& code, const Eigen::Vector2d& pixel) const {
    Eigen::Vector2d at = pixel;
    for (int step = 0; step < kMaxSteps; ++step) {
        if (!(at.minCoeff() > -0.5 && at.x() < view_.width - 0.5 && at.y() < view_.height - 0.5)) return std::nullopt;
        const int x = static_cast<int>(at.x() + 0.5), y = static_cast<int>(at.y() + 0.5);
        const auto local = local_code(view_, x, y);
        if (!local) return std::nullopt;
        // The view's rows and columns must both be resolved there, or the place is not determined.
        const double determinant = local->by_pixel.determinant();
        if (std::abs(determinant) < 1e-3 * local->by_pixel.squaredNorm()) return std::nullopt;
        const Eigen::Matrix2d pixel_by_code = local->by_pixel.inverse();
        const Eigen::Vector2d d = pixel_by_code * (code - local->code);
        at = Eigen::Vector2d(x, y) + d;
        if (d.cwiseAbs().maxCoeff() <= 0.75) return Match{code, at, *local, pixel_by_code};
        if (d.cwiseAbs().maxCoeff() > kMaxWay_px) return std::nullopt;
    }
    return std::nullopt;
}

}  // namespace planlight
