#include "registration/tracking/ellipse.h"
#include "planning_io/types/statistics.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace planlight {
namespace {

using Vector5 = Eigen::Matrix<double, 5, 1>;
using Matrix5 = Eigen::Matrix<double, 5, 5>;

bool is_ellipse(const Ellipse& e) {
    return e.centre.allFinite() && e.shape.allFinite() && e.shape.trace() > 0 && e.shape.determinant() > 1e-12;
}

/// The conic (1+p0) x^2 + 2 p1 xy + (1-p0) y^2 + p2 x + p3 y + p4 = 0 as an ellipse.
std::optional<Ellipse> ellipse_of_conic(const Vector5& p) {
    Eigen::Matrix2d Q;
    Q << 1 + p[0], p[1], p[1], 1 - p[0];
    if (Q.determinant() <= 1e-9) return std::nullopt;
    Ellipse e;
    e.centre = -0.5 * Q.inverse() * p.segment<2>(2);
    const double level = e.centre.dot(Q * e.centre) - p[4];
    e.shape = level * Q.inverse();
    if (level <= 0 || !is_ellipse(e)) return std::nullopt;
    return e;
}

/// A pixel of the edge: the line of equal brightness through it, in coordinates centred and scaled by the start
/// ellipse.
struct EdgeLine {
    Eigen::Vector2d normal;  ///< unit
    double offset;           ///< normal . x = offset on the line
    double weight;           ///< squared gradient
};

std::vector<EdgeLine> collect_lines(const GrayImage& picture, const Ellipse& start, double half_width_px,
                                    double scale) {
    std::vector<EdgeLine> lines;
    const Eigen::Vector2d reach = start.shape.diagonal().cwiseSqrt().array() + half_width_px + 1;
    const int x0 = static_cast<int>(std::floor(start.centre.x() - reach.x()));
    const int x1 = static_cast<int>(std::ceil(start.centre.x() + reach.x()));
    const int y0 = static_cast<int>(std::floor(start.centre.y() - reach.y()));
    const int y1 = static_cast<int>(std::ceil(start.centre.y() + reach.y()));
    if (x0 < 1 || y0 < 1 || x1 > picture.width - 2 || y1 > picture.height - 2) return lines;
    const Eigen::Matrix2d inverse = start.shape.inverse();
    lines.reserve(static_cast<std::size_t>(6 * (reach.x() + reach.y()) * half_width_px));
    const std::size_t stride = static_cast<std::size_t>(picture.width);
    for (int y = y0; y <= y1; ++y) {
        for (int x = x0; x <= x1; ++x) {
            const Eigen::Vector2d d = Eigen::Vector2d(x, y) - start.centre;
            const Eigen::Vector2d g_ellipse = inverse * d;
            const double rho2 = d.dot(g_ellipse);
            const double rho = std::sqrt(rho2);
            if (std::abs(rho - 1) * rho > half_width_px * g_ellipse.norm()) continue;
            const std::uint8_t* p = picture.pixels.data() + picture.index(x, y);
            const std::uint8_t* up = p - stride;
            const std::uint8_t* down = p + stride;
            // Scharr's kernel: the direction of the gradient is right to a fraction of a degree.
            const double gx = 3 * (up[1] - up[-1] + down[1] - down[-1]) + 10 * (p[1] - p[-1]);
            const double gy = 3 * (down[-1] - up[-1] + down[1] - up[1]) + 10 * (down[0] - up[0]);
            const Eigen::Vector2d g(gx, gy);
            const double strength = g.norm();
            if (strength < 16 || g.dot(g_ellipse) < 0.7 * strength * g_ellipse.norm()) continue;
            const Eigen::Vector2d n = g / strength;
            lines.push_back({n, n.dot(d) / scale, strength * strength});
        }
    }
    return lines;
}

}  // namespace

Eigen::Vector2d Ellipse::half_axes() const {
    const double half_trace = 0.5 * shape.trace();
    const double root = std::sqrt(std::max(0.0, half_trace * half_trace - shape.determinant()));
    return {std::sqrt(half_trace + root), std::sqrt(std::max(0.0, half_trace - root))};
}

Eigen::Matrix2d Ellipse::from_unit_circle() const {
    return Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(shape).operatorSqrt();
}

double Ellipse::distance(const Eigen::Vector2d& pixel) const {
    const Eigen::Vector2d d = pixel - centre;
    const Eigen::Vector2d g = shape.inverse() * d;
    const double rho = std::sqrt(std::max(0.0, d.dot(g)));
    return (rho - 1) * rho / std::max(1e-12, g.norm());
}

Ellipse circle(const Eigen::Vector2d& centre, double radius_px) {
    return {centre, radius_px * radius_px * Eigen::Matrix2d::Identity()};
}

std::optional<Ellipse> fit_ellipse_to_points(const std::vector<Eigen::Vector2d>& points, std::vector<bool>& used) {
    used.assign(points.size(), true);
    std::optional<Ellipse> result;
    for (int pass = 0; pass < 4; ++pass) {
        Eigen::Vector2d middle = Eigen::Vector2d::Zero();
        int count = 0;
        for (std::size_t i = 0; i < points.size(); ++i)
            if (used[i]) middle += points[i], ++count;
        if (count < 8) return std::nullopt;
        middle /= count;
        double scale = 0;
        for (std::size_t i = 0; i < points.size(); ++i)
            if (used[i]) scale += (points[i] - middle).norm() / count;
        if (scale < 1e-6) return std::nullopt;
        Matrix5 N = Matrix5::Zero();
        Vector5 b = Vector5::Zero();
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (!used[i]) continue;
            const Eigen::Vector2d p = (points[i] - middle) / scale;
            Vector5 row;
            row << p.x() * p.x() - p.y() * p.y(), 2 * p.x() * p.y(), p.x(), p.y(), 1;
            N.selfadjointView<Eigen::Lower>().rankUpdate(row);
            b -= p.squaredNorm() * row;
        }
        result = ellipse_of_conic(N.selfadjointView<Eigen::Lower>().ldlt().solve(b));
        if (!result) return std::nullopt;
        result->centre = middle + scale * result->centre;
        result->shape *= scale * scale;
        if (pass == 3) break;
        std::vector<double> distances;
        for (const auto& p : points) distances.push_back(std::abs(result->distance(p)));
        const double gate = std::max(0.4, 3.5 * median(distances));
        for (std::size_t i = 0; i < points.size(); ++i) used[i] = distances[i] <= gate;
    }
    return result;
}

std::optional<Ellipse> fit_ellipse_to_gradients(const GrayImage& picture, const Ellipse& start, double half_width_px) {
    const Eigen::Vector2d axes = start.half_axes();
    const double scale = 0.5 * axes.sum();
    std::vector<EdgeLine> lines = collect_lines(picture, start, half_width_px, scale);
    if (lines.size() < 24) return std::nullopt;
    Ellipse result;
    for (int pass = 0; pass < 3; ++pass) {
        // With C* = [A B D; B C E; D E 1] and l = (n, -h): A nx^2 + 2B nx ny + C ny^2 - 2D nx h - 2E ny h = -h^2.
        Matrix5 N = Matrix5::Zero();
        Vector5 b = Vector5::Zero();
        const auto row_of = [](const EdgeLine& l) {
            const double nx = l.normal.x(), ny = l.normal.y();
            Vector5 row;
            row << nx * nx, 2 * nx * ny, ny * ny, -2 * nx * l.offset, -2 * ny * l.offset;
            return row;
        };
        double weights = 0;
        for (const EdgeLine& l : lines) {
            const Vector5 row = row_of(l);
            N.noalias() += l.weight * row * row.transpose();
            b -= l.weight * l.offset * l.offset * row;
            weights += l.weight;
        }
        const Eigen::LDLT<Matrix5> solver(N);
        const Vector5 p = solver.solve(b);
        Eigen::Matrix2d quadratic;
        quadratic << p[0], p[1], p[1], p[2];
        Ellipse e{p.tail<2>(), p.tail<2>() * p.tail<2>().transpose() - quadratic};
        if (!is_ellipse(e)) return std::nullopt;
        double sum = 0;
        for (const EdgeLine& l : lines) {
            const double r = row_of(l).dot(p) + l.offset * l.offset;
            sum += l.weight * r * r;
        }
        const double variance = sum / weights;
        if (pass < 2) {
            for (EdgeLine& l : lines) {
                const double r = row_of(l).dot(p) + l.offset * l.offset;
                if (r * r > 6.25 * variance) l.weight *= 6.25 * variance / (r * r);
            }
            continue;
        }
        result.centre = start.centre + scale * e.centre;
        result.shape = scale * scale * e.shape;
    }
    return result;
}

}  // namespace planlight
