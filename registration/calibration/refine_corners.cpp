#include "registration/calibration/refine_corners.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <optional>

namespace planlight {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Vector9d = Eigen::Matrix<double, 9, 1>;
using Matrix9d = Eigen::Matrix<double, 9, 9>;

constexpr double kAlong = 0.4;                               ///< squares of an edge to either side of its corner
constexpr double kAlongMost_px = 24;                         ///< farther off, distortion bends an edge
constexpr double kRingOfMarked = 0.125, kRingOfPlain = 0.3;  ///< squares beside an edge that show nothing but the edge
constexpr double kMargin_px = 1.5;                           ///< within which what lies beyond them shines in
constexpr int kLeastPixels = 30, kRounds = 30, kPasses = 2;

struct Sample {
    Vector2d off;  ///< from where the corner was thought to be, pixels
    double grey;
};

/// Two blurred edges that cross: grey = (middle + half S(d0) S(d1)) (1 + fall . off), S(d) = erf(d / (sqrt 2 blur)), d
/// the distance from an edge. Numbers: x, y, angle of either edge, blur, middle, half, fall.
struct Crossing {
    Vector9d numbers;

    double grey_at(const Vector2d& off, Vector9d* by_numbers = nullptr) const {
        const double blur = numbers[4], middle = numbers[5], half = numbers[6];
        const Vector2d arm = off - numbers.head<2>();
        std::array<double, 2> step, slope, distance, along;
        std::array<Vector2d, 2> across;
        for (std::size_t k = 0; k < 2; ++k) {
            const double angle = numbers[2 + static_cast<Eigen::Index>(k)];
            across[k] = {-std::sin(angle), std::cos(angle)};
            distance[k] = across[k].dot(arm);
            along[k] = across[k].y() * arm.x() - across[k].x() * arm.y();
            step[k] = std::erf(distance[k] / (M_SQRT2 * blur));
            slope[k] = std::sqrt(2 / M_PI) / blur * std::exp(-distance[k] * distance[k] / (2 * blur * blur));
        }
        const double light = 1 + numbers.tail<2>().dot(off), grey = middle + half * step[0] * step[1];
        if (by_numbers) {
            const double by_0 = light * half * slope[0] * step[1], by_1 = light * half * step[0] * slope[1];
            by_numbers->head<2>() = -by_0 * across[0] - by_1 * across[1];
            (*by_numbers)[2] = -by_0 * along[0];
            (*by_numbers)[3] = -by_1 * along[1];
            (*by_numbers)[4] = -(by_0 * distance[0] + by_1 * distance[1]) / blur;
            (*by_numbers)[5] = light;
            (*by_numbers)[6] = light * step[0] * step[1];
            by_numbers->tail<2>() = grey * off;
        }
        return light * grey;
    }

    double squares(const std::vector<Sample>& samples) const {
        double sum = 0;
        for (const Sample& s : samples) sum += std::pow(s.grey - grey_at(s.off), 2);
        return sum;
    }
};

/// Pixels along the four sides that meet in a corner. `px_of_square`: the board's two directions, a square each.
std::vector<Sample> samples_round(const GrayImage& picture, const Vector2d& corner, const Matrix2d& px_of_square,
                                  double ring) {
    const Matrix2d square_of_px = px_of_square.inverse();
    const Vector2d along = (kAlongMost_px * px_of_square.colwise().norm().cwiseInverse().transpose()).cwiseMin(kAlong);
    const double reach_x = px_of_square.row(0).cwiseAbs().dot(along),
                 reach_y = px_of_square.row(1).cwiseAbs().dot(along);
    // Of both directions: squares a pixel, straight off the edge.
    const Vector2d per_px = square_of_px.rowwise().norm();
    const Vector2d widths = (Vector2d::Constant(ring) - kMargin_px * per_px).cwiseMax(kMargin_px * per_px);
    std::vector<Sample> samples;
    const int x0 = std::max(0, static_cast<int>(corner.x() - reach_x)),
              y0 = std::max(0, static_cast<int>(corner.y() - reach_y));
    const int x1 = std::min(picture.width - 1, static_cast<int>(corner.x() + reach_x) + 1),
              y1 = std::min(picture.height - 1, static_cast<int>(corner.y() + reach_y) + 1);
    for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x) {
            const Vector2d off(x - corner.x(), y - corner.y()), at = (square_of_px * off).cwiseAbs();
            if (at.x() < along.x() && at.y() < along.y() && (at.x() < widths.x() || at.y() < widths.y()))
                samples.push_back({off, static_cast<double>(picture.at(x, y))});
        }
    return samples;
}

Crossing first_guess(const std::vector<Sample>& samples, const Matrix2d& px_of_square) {
    const Matrix2d square_of_px = px_of_square.inverse();
    std::array<double, 2> sum{}, count{};
    for (const Sample& s : samples) {
        const Vector2d at = square_of_px * s.off;
        const std::size_t side = at.x() * at.y() > 0;
        sum[side] += s.grey;
        ++count[side];
    }
    const double same = sum[1] / std::max(1.0, count[1]), other = sum[0] / std::max(1.0, count[0]);
    Crossing guess;
    const Vector2d x = px_of_square.col(0), y = px_of_square.col(1);
    const double side =
        x.x() * y.y() - x.y() * y.x() > 0 ? -1 : 1;  // of S(d0) S(d1) where both board directions are positive
    guess.numbers << 0, 0, std::atan2(x.y(), x.x()), std::atan2(y.y(), y.x()), 1, (same + other) / 2,
        side * (same - other) / 2, 0, 0;
    return guess;
}

/// Levenberg-Marquardt; empty when it does not settle.
std::optional<Vector2d> fit_crossing(const std::vector<Sample>& samples, Crossing crossing) {
    double damping = 1e-3, squares = crossing.squares(samples);
    for (int round = 0; round < kRounds; ++round) {
        Matrix9d normal = Matrix9d::Zero();
        Vector9d right = Vector9d::Zero(), by_numbers;
        for (const Sample& s : samples) {
            const double off = s.grey - crossing.grey_at(s.off, &by_numbers);
            normal.selfadjointView<Eigen::Lower>().rankUpdate(by_numbers);
            right += off * by_numbers;
        }
        normal.triangularView<Eigen::StrictlyUpper>() = normal.transpose();
        Matrix9d damped = normal;
        damped.diagonal() *= 1 + damping;
        const Vector9d step = damped.ldlt().solve(right);
        Crossing next{crossing.numbers + step};
        next.numbers[4] = std::clamp(next.numbers[4], 0.25, 5.0);
        const double then = next.squares(samples);
        if (!(then <= squares)) {
            damping *= 10;
            if (damping > 1e6) return std::nullopt;
            continue;
        }
        crossing = next;
        squares = then;
        damping = std::max(1e-9, damping / 10);
        if (step.head<2>().norm() < 1e-4) return crossing.numbers.head<2>();
    }
    return std::nullopt;
}

}  // namespace

void refine_corners(const GrayImage& picture, const BoardSpec& board, BoardCorners& corners) {
    if (!spans_a_plane(corners, board)) return;
    std::vector<cv::Point2d> squares, pixels;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Eigen::Vector3d p = board.corner_in_board(corners.ids[i]) / board.square_mm;
        squares.emplace_back(p.x(), p.y());
        pixels.emplace_back(corners.pixels[i].x(), corners.pixels[i].y());
    }
    const cv::Mat found = cv::findHomography(squares, pixels, 0);
    if (found.empty()) return;
    Eigen::Matrix3d h;
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) h(r, c) = found.at<double>(r, c);
    const double ring = board.kind == BoardSpec::Kind::charuco ? kRingOfMarked : kRingOfPlain;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Eigen::Vector3d at = h * Eigen::Vector3d(squares[i].x, squares[i].y, 1);
        const Matrix2d px_of_square =
            (h.topLeftCorner<2, 2>() - at.hnormalized() * h.bottomLeftCorner<1, 2>()) / at.z();
        Vector2d corner = corners.pixels[i];
        for (int pass = 0; pass < kPasses; ++pass) {
            const auto samples = samples_round(picture, corner, px_of_square, ring);
            const auto moved = samples.size() < kLeastPixels
                                   ? std::nullopt
                                   : fit_crossing(samples, first_guess(samples, px_of_square));
            corner += moved.value_or(Vector2d::Constant(1e9));
        }
        if ((px_of_square.inverse() * (corner - corners.pixels[i])).norm() < 0.25) corners.pixels[i] = corner;
    }
}

}  // namespace planlight
