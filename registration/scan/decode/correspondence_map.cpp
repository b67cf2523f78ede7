#include "registration/scan/decode/correspondence_map.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "planning_io/types/processor_clones.h"

namespace planlight {
namespace {

constexpr int kReach = 2, kSide = 2 * kReach + 1;  // 5 x 5 neighbours
constexpr int kWhole = kSide * kSide;
constexpr float kByCount = 1.0f / kWhole, kBySquares = 1.0f / 50;  // of a plane over all of them
constexpr int kMinNeighbours = 12;                                 // about half of them
constexpr float kRoughness_px =
    0.25f;  // rms about the affine map that the surface's own curvature and texture may make
// A camera pixel spans a few projector pixels at most; a jump of more is another surface, not a slope.
constexpr float kMaxJump_px = 12;
constexpr int kMaxSteps = 5;
constexpr int kCell_px = 4, kRings = 2;  // of the index: a view may see the projector's pixels coarsely
constexpr int kTries = 4;                // from cells where the search fails: nearly all of them end at the same edge
constexpr double kMaxWay_px = 16;        // from where the search begins to what it finds

// Of the quadratic fit over all 25 neighbours: sums of (x^2 - 2)^2, and what is then taken off the mean at the centre.
constexpr float kQuadraticSquares = 70, kMeanOfSquares = 2;
constexpr float kQuadricVariance =
    2 * kMeanOfSquares * kMeanOfSquares / kQuadraticSquares;  // what that adds, of one pixel's
// A code with this noise (projector pixels) is fitted half way between a plane and a quadric: the quadric's value at
// the centre has sqrt(0.114) times the noise more, and skin's detail bends the code by about 0.06 px over the window.
constexpr float kHalfWaySigma_px = 0.2f;
// Over what variance (camera pixels squared, an axis) the lens and the skin spread light: a lens as it is focused (0.6
// to 0.8 px), and as much again in the skin. The radius of the ball of `measure_scan_rooms` tells (scan/ACCURACY.md).
constexpr float kSpread_px2 = 1;
// Slope of the light's logarithm, a pixel, above which it is more an edge (of the projector's picture, a shadow, ink)
// than the shading of a surface: there the code is no quadric and the light not spread evenly about its slope.
constexpr float kEdge = 0.16f;

/// Sums of a weighted affine fit, weights 0 or 1, about the centre's own code (column, row).
struct Sums {
    float n = 0, c[2] = {}, cx[2] = {}, cy[2] = {}, cc = 0;
    float squares[2] = {}, light = 0, light_x = 0,
          light_y = 0;                           ///< of (x^2 + y^2) code; of light, and x and y times it
    float x = 0, y = 0, xx = 0, xy = 0, yy = 0;  ///< set where n is less than kWhole: else x, y, xy vanish
};

typedef float Lanes __attribute__((vector_size(32)));
typedef std::int32_t Mask __attribute__((vector_size(32)));
typedef float Four __attribute__((vector_size(16)));

/// The sums over the lanes of four vectors.
PLANLIGHT_INLINE void sum_lanes(const Lanes& a, const Lanes& b, const Lanes& c, const Lanes& d, Four& sums) {
    const Lanes ab = __builtin_shufflevector(a, b, 0, 8, 1, 9, 2, 10, 3, 11) +
                     __builtin_shufflevector(a, b, 4, 12, 5, 13, 6, 14, 7, 15);
    const Lanes cd = __builtin_shufflevector(c, d, 0, 8, 1, 9, 2, 10, 3, 11) +
                     __builtin_shufflevector(c, d, 4, 12, 5, 13, 6, 14, 7, 15);
    const Lanes abcd = __builtin_shufflevector(ab, cd, 0, 1, 8, 9, 2, 3, 10, 11) +
                       __builtin_shufflevector(ab, cd, 4, 5, 12, 13, 6, 7, 14, 15);
    sums = __builtin_shufflevector(abcd, abcd, 0, 1, 2, 3) + __builtin_shufflevector(abcd, abcd, 4, 5, 6, 7);
}

/// The sums over the 5 x 5 neighbours that are decoded and no jump away. Five rows of eight lanes, of which five count;
/// `column`, `row` and `dim` point at the centre pixel, with three more floats to read behind the last neighbour. Null
/// `row`: columns only.
PLANLIGHT_CLONES void sum_neighbours(const float* column, const float* row, const float* dim, std::ptrdiff_t width,
                                     float max_jump_px, Sums& sums) {
    const Mask use = {-1, -1, -1, -1, -1, 0, 0, 0}, size_only = Mask{} + 0x7fffffff;
    const Lanes dx = {-2, -1, 0, 1, 2, 0, 0, 0}, limit = Lanes{} + max_jump_px, column_here = Lanes{} + *column,
                row_here = Lanes{} + (row ? *row : 0);
    Lanes c = {}, r = {}, c_by_y = {}, r_by_y = {}, c_by_yy = {}, r_by_yy = {}, squares = {}, light = {},
          light_by_y = {};
    Lanes n = {}, y = {}, yy = {};
#pragma GCC unroll 5
    for (int dy = -kReach; dy <= kReach; ++dy) {
        const auto by = static_cast<float>(dy);
        Lanes dc, dr = {};
        std::memcpy(&dc, column + dy * width - kReach, sizeof dc);
        dc -= column_here;
        Mask good = use & ((Lanes)((Mask)dc & size_only) <= limit);  // NaN fails
        if (row) {
            std::memcpy(&dr, row + dy * width - kReach, sizeof dr);
            dr -= row_here;
            good &= (Lanes)((Mask)dr & size_only) <= limit;
            dr = (Lanes)((Mask)dr & good);
            r += dr;
            r_by_y += by * dr;
            r_by_yy += by * by * dr;
        }
        dc = (Lanes)((Mask)dc & good);
        c += dc;
        c_by_y += by * dc;
        c_by_yy += by * by * dc;
        Lanes bright;
        std::memcpy(&bright, dim + dy * width - kReach, sizeof bright);
        bright = (Lanes)((Mask)(1 / bright) & good);
        light += bright;
        light_by_y += by * bright;
        squares += dc * dc + dr * dr;
        const Lanes one = (Lanes)((Mask)(Lanes{} + 1) & good);
        n += one;
        y += by * one;
        yy += by * by * one;
    }
    Four first, second;
    sum_lanes(c, r, c_by_y, r_by_y, first);
    sum_lanes(dx * c, dx * r, squares, n, second);
    sums.c[0] = first[0], sums.c[1] = first[1], sums.cy[0] = first[2], sums.cy[1] = first[3];
    sums.cx[0] = second[0], sums.cx[1] = second[1], sums.cc = second[2], sums.n = second[3];
    if (sums.n == kWhole) {
        sum_lanes(dx * dx * c + c_by_yy, dx * dx * r + r_by_yy, dx * light, light_by_y, first);
        sum_lanes(light, Lanes{}, Lanes{}, Lanes{}, second);
        sums.squares[0] = first[0], sums.squares[1] = first[1], sums.light_x = first[2], sums.light_y = first[3];
        sums.light = second[0];
        return;
    }
    sum_lanes(dx * n, dx * dx * n, dx * y, y, first);
    sum_lanes(yy, Lanes{}, Lanes{}, Lanes{}, second);
    sums.x = first[0], sums.xx = first[1], sums.xy = first[2], sums.y = first[3], sums.yy = second[0];
}

/// The same at the rim of a picture: on a copy of the neighbourhood, what lies outside is not decoded.
void sum_at_rim(const DecodedView& view, int x, int y, Sums& sums) {
    constexpr int kStep = 8;
    std::array<float, kSide * kStep> column, row, dim;
    column.fill(std::numeric_limits<float>::quiet_NaN());
    row.fill(0);
    dim.fill(1);
    for (int dy = 0; dy < kSide; ++dy)
        for (int dx = 0; dx < kSide; ++dx) {
            const int px = x + dx - kReach, py = y + dy - kReach;
            if (px < 0 || py < 0 || px >= view.width || py >= view.height) continue;
            const std::size_t from =
                static_cast<std::size_t>(py) * static_cast<std::size_t>(view.width) + static_cast<std::size_t>(px);
            const auto to = static_cast<std::size_t>(dy * kStep + dx);
            column[to] = view.column[from];
            if (!view.row.empty()) row[to] = view.row[from];
            dim[to] = dimness_of(view)[from];
        }
    constexpr std::size_t kCentre = kReach * kStep + kReach;
    sum_neighbours(&column[kCentre], &row[kCentre], &dim[kCentre], kStep, kMaxJump_px, sums);
}

/// What is left after the fit must be roughness and noise, and the pixel itself must not stand off.
PLANLIGHT_INLINE bool smooth(float residual, float freedom, float own_squared, float sigma_px, float directions) {
    const float allowed = kRoughness_px * kRoughness_px + 9 * sigma_px * sigma_px;
    return residual <= directions * freedom * allowed && own_squared <= 9 * directions * allowed;
}

/// The plane over all 25 neighbours: sums of x, y and x y vanish, those of x^2 and y^2 are 50. Nearly all fits are of
/// these.
PLANLIGHT_INLINE bool fit_whole(const Sums& s, double column, double row, float sigma_px, float directions,
                                Correspondence& local) {
    const float c = s.c[0], r = s.c[1], cx = s.cx[0], rx = s.cx[1], cy = s.cy[0], ry = s.cy[1];
    const float centres = (c * c + r * r) * kByCount;
    const float residual = s.cc - centres - (cx * cx + rx * rx + cy * cy + ry * ry) * kBySquares;
    if (!smooth(residual, kWhole - 3, centres * kByCount, sigma_px, directions)) return false;
    local.by_pixel << cx * kBySquares, cy * kBySquares, rx * kBySquares, ry * kBySquares;
    local.code = {column + c * kByCount, row + r * kByCount};
    local.whole = true;
    local.sigma_px = sigma_px * (1.0f / kSide);
    return true;
}

/// From the plane over all neighbours to what the code is at the centre: the quadric there, and as it would be without
/// the light that lens and skin bring from beside it, more from where there is more.
PLANLIGHT_INLINE void sharpen(const Sums& s, float sigma_px, Correspondence& local) {
    const float by_light = kBySquares * kWhole / s.light, slope_x = s.light_x * by_light,
                slope_y = s.light_y * by_light;
    const float steep = (slope_x * slope_x + slope_y * slope_y) * (1 / (kEdge * kEdge));
    const float noisy = 1 + sigma_px * sigma_px * (1 / (kHalfWaySigma_px * kHalfWaySigma_px));
    const float quadric = 1 / ((1 + steep * steep) * noisy), towards = kSpread_px2 * kBySquares * quadric * noisy;
    // Half the second derivatives, summed, come from the sums of (x^2 - 2 + y^2 - 2) times the code.
    const float bend = -kMeanOfSquares * quadric * (1 / kQuadraticSquares);
    const float x = towards * slope_x, y = towards * slope_y;
    local.code.x() += bend * (s.squares[0] - 2 * kMeanOfSquares * s.c[0]) - (s.cx[0] * x + s.cy[0] * y);
    local.code.y() += bend * (s.squares[1] - 2 * kMeanOfSquares * s.c[1]) - (s.cx[1] * x + s.cy[1] * y);
    local.sigma_px = sigma_px * std::sqrt(kByCount + kQuadricVariance * quadric * quadric);
}

/// The fit over what there is of them.
bool fit_part(const Sums& s, const Eigen::Vector2d& centre, float sigma_px, float directions, Correspondence& local) {
    if (s.n < kMinNeighbours) return false;
    Eigen::Matrix3d A;
    A << s.n, s.x, s.y, s.x, s.xx, s.xy, s.y, s.xy, s.yy;
    Eigen::Matrix<double, 3, 2> b;
    b << s.c[0], s.c[1], s.cx[0], s.cx[1], s.cy[0], s.cy[1];
    bool invertible = false;
    Eigen::Matrix3d inverse;
    A.computeInverseWithCheck(inverse, invertible, 1e-6);
    if (!invertible) return false;
    const Eigen::Matrix<double, 3, 2> fit = inverse * b;
    const double residual = s.cc - (fit.array() * b.array()).sum();
    if (!smooth(static_cast<float>(residual), s.n - 3, static_cast<float>(fit.row(0).squaredNorm()), sigma_px,
                directions))
        return false;
    local = {centre + fit.row(0).transpose(), fit.bottomRows<2>().transpose(), false,
             sigma_px * std::sqrt(inverse(0, 0))};
    return true;
}

std::size_t place_of(const DecodedView& view, int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width) + static_cast<std::size_t>(x);
}

/// The plane over the neighbours: enough to find where to go.
PLANLIGHT_INLINE bool fit_plane(const DecodedView& view, int x, int y, Sums& sums, Correspondence& local) {
    const std::size_t i = place_of(view, x, y);
    if (std::isnan(view.column[i])) return false;
    const bool rows = !view.row.empty();
    const double column = view.column[i], row = rows ? view.row[i] : 0.0;
    const float directions = rows ? 2 : 1;
    const float* dim = &dimness_of(view)[i];
    if (x >= kReach && y >= kReach && x + kReach < view.width && y + kReach + 1 < view.height && view.width > 8)
        sum_neighbours(&view.column[i], rows ? &view.row[i] : nullptr, dim, view.width, kMaxJump_px, sums);
    else
        sum_at_rim(view, x, y, sums);
    return sums.n == kWhole ? fit_whole(sums, column, row, view.sigma_px[i], directions, local)
                            : fit_part(sums, {column, row}, view.sigma_px[i], directions, local);
}

}  // namespace

bool fit_correspondence(const DecodedView& view, int x, int y, Correspondence& local) {
    Sums sums;
    if (!fit_plane(view, x, y, sums, local)) return false;
    if (local.whole) sharpen(sums, view.sigma_px[place_of(view, x, y)], local);
    return true;
}

std::optional<Correspondence> correspondence_at(const DecodedView& view, int x, int y) {
    Correspondence local;
    return fit_correspondence(view, x, y, local) ? std::optional(local) : std::nullopt;
}

CorrespondenceIndex::CorrespondenceIndex(const DecodedView& view, int projector_width, int projector_height)
    : view_(view),
      columns_((projector_width + kCell_px - 1) / kCell_px),
      rows_((projector_height + kCell_px - 1) / kCell_px),
      pixel_in_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), -1) {
    constexpr float kByCell = 1.0f / kCell_px;
    // Every third pixel of every third line: a piece of code without one of them is too small to be fitted.
    for (int y = 0; y < view.height; y += 3) {
        const std::size_t line = static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width);
        for (int x = 0; x < view.width; x += 3) {
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

bool CorrespondenceIndex::find(const Eigen::Vector2d& code, Match& match) const {
    if (!(code.minCoeff() > -kCell_px)) return false;
    const int c = static_cast<int>((code.x() + 0.5) / kCell_px), r = static_cast<int>((code.y() + 0.5) / kCell_px);
    int tries = 0;
    for (int ring = 0; ring <= kRings; ++ring)
        for (int y = std::max(0, r - ring); y <= std::min(rows_ - 1, r + ring); ++y)
            for (int x = std::max(0, c - ring); x <= std::min(columns_ - 1, c + ring); ++x) {
                if (std::max(std::abs(y - r), std::abs(x - c)) != ring) continue;
                const std::int32_t start = pixel_in_[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) +
                                                     static_cast<std::size_t>(x)];
                if (start < 0) continue;
                if (find_from(code, {start % view_.width, start / view_.width}, match)) return true;
                if (++tries == kTries) return false;
            }
    return false;
}

bool CorrespondenceIndex::find_from(const Eigen::Vector2d& code, const Eigen::Vector2d& pixel, Match& match) const {
    Eigen::Vector2d at = pixel;
    Correspondence& local = match.local;
    for (int step = 0; step < kMaxSteps; ++step) {
        if (!(at.minCoeff() > -0.5 && at.x() < view_.width - 0.5 && at.y() < view_.height - 0.5)) return false;
        const int x = static_cast<int>(at.x() + 0.5), y = static_cast<int>(at.y() + 0.5);
        Sums sums;
        if (!fit_plane(view_, x, y, sums, local)) return false;
        // The view's rows and columns must both be resolved there, or the place is not determined.
        const Eigen::Matrix2d& by_pixel = local.by_pixel;
        const double determinant = by_pixel(0, 0) * by_pixel(1, 1) - by_pixel(0, 1) * by_pixel(1, 0);
        if (std::abs(determinant) < 1e-3 * by_pixel.squaredNorm()) return false;
        const double by_determinant = 1 / determinant;
        match.pixel_by_code << by_pixel(1, 1) * by_determinant, -by_pixel(0, 1) * by_determinant,
            -by_pixel(1, 0) * by_determinant, by_pixel(0, 0) * by_determinant;
        const Eigen::Vector2d d = match.pixel_by_code * (code - local.code);
        at = Eigen::Vector2d(x, y) + d;
        if (d.cwiseAbs().maxCoeff() <= 0.75) {
            if (local.whole) sharpen(sums, view_.sigma_px[place_of(view_, x, y)], local);
            match.code = code;
            match.pixel = Eigen::Vector2d(x, y) + match.pixel_by_code * (code - local.code);
            return true;
        }
        if (d.cwiseAbs().maxCoeff() > kMaxWay_px) return false;
    }
    return false;
}

}  // namespace planlight
