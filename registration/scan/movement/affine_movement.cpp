#include "registration/scan/movement/affine_movement.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "registration/scan/check/picture_noise.h"

namespace planlight::affine_movement {
namespace {

constexpr int kReach_px = 4;   // a pixel is used where all is lit so far around it
constexpr int kSpoilt_px = 6;  // and nothing is saturated so far
constexpr int kSaturated = 250;
constexpr int kPatchesAcross = 8;

using Numbers = Eigen::Matrix<double, kNumbers, 1>;
using Normal = Eigen::Matrix<double, kNumbers, kNumbers>;

/// The brightest value of each pixel over all frames that take part.
std::vector<std::uint8_t> brightest(const Pictures& pictures, const std::vector<Moment>& moments) {
    const auto& white = pictures.frames[pictures.white].pixels;
    std::vector<std::uint8_t> most(white.begin(), white.end());
    for (const Moment& moment : moments)
        for (const std::size_t k : moment.frames) {
            const auto& pixels = pictures.frames[k].pixels;
            for (std::size_t i = 0; i < most.size(); ++i) most[i] = std::max(most[i], pixels[i]);
        }
    return most;
}

/// The greatest value within `reach` along a line and along a column.
void spread(std::vector<std::uint8_t>& values, int width, int height, int reach) {
    std::vector<std::uint8_t> once(values.size());
    const auto at = [&](int x, int y) {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            std::uint8_t most = 0;
            for (int k = std::max(0, x - reach); k <= std::min(width - 1, x + reach); ++k)
                most = std::max(most, values[at(k, y)]);
            once[at(x, y)] = most;
        }
    for (int y = 0; y < height; ++y) {
        std::copy_n(once.begin() + static_cast<std::ptrdiff_t>(at(0, y)), width,
                    values.begin() + static_cast<std::ptrdiff_t>(at(0, y)));
        for (int k = std::max(0, y - reach); k <= std::min(height - 1, y + reach); ++k)
            for (int x = 0; x < width; ++x) values[at(x, y)] = std::max(values[at(x, y)], once[at(x, k)]);
    }
}

}  // namespace

float Pictures::even_at(const Moment& moment, int x, int y) const {
    const auto mean = [&](std::size_t k) {
        const GrayImage& frame = frames[k];
        float sum = 0;
        for (int dy = -1; dy <= 1; ++dy) {
            const std::uint8_t* p = &frame.pixels[frame.index(x, y + dy)];
            sum += light[p[-1]] + light[p[0]] + light[p[1]];
        }
        return sum / 9;
    };
    if (moment.lit_only) return mean(moment.frames.front()) + mean(black);
    float sum = 0;
    for (const std::size_t k : moment.frames) sum += mean(k);
    return sum * 2 / static_cast<float>(moment.frames.size());
}

Surface::Surface(const Pictures& pictures, const Moment& first, const std::vector<Moment>& moments)
    : pictures_(pictures) {
    const GrayImage& white = pictures.frames[pictures.white];
    std::vector<std::uint8_t> spoilt = brightest(pictures, moments);
    for (std::uint8_t& value : spoilt) value = value >= kSaturated;
    spread(spoilt, white.width, white.height, kSpoilt_px);
    choose(spoilt, first);
    if (!enough()) return;
    Eigen::Array2d sum = Eigen::Array2d::Zero(), squares = sum, low = Eigen::Array2d::Constant(1e9), high = -low;
    for (const Pixel& p : pixels_) {
        const Eigen::Array2d at(p.x, p.y);
        sum += at;
        squares += at.square();
        low = low.min(at);
        high = high.max(at);
    }
    const auto n = static_cast<double>(pixels_.size());
    centre_ = sum / n;
    scale_ = std::max(1.0, std::sqrt((squares / n - (sum / n).square()).sum()));
    const Eigen::Array2d side = (high - low + 1) / kPatchesAcross;
    for (Pixel& p : pixels_)
        p.patch = static_cast<int>((p.y - low.y()) / side.y()) * kPatchesAcross +
                  static_cast<int>((p.x - low.x()) / side.x());
    patches_ = kPatchesAcross * kPatchesAcross;
}

void Surface::choose(const std::vector<std::uint8_t>& spoilt, const Moment& first) {
    constexpr float kLeastLight_grey = 12,
                    kSteepest = 60;  // grey a pixel (of twice the grey values): an edge of the head
    const GrayImage &white = pictures_.frames[pictures_.white], &black = pictures_.frames[pictures_.black];
    const double noise_grey = 5 * noise_in_dark(white, black);
    const auto light_at = [&](std::size_t i) {
        return pictures_.light[white.pixels[i]] - pictures_.light[black.pixels[i]];
    };
    const auto lit = [&](std::size_t i) {
        return light_at(i) > kLeastLight_grey && white.pixels[i] > black.pixels[i] + noise_grey;
    };
    std::vector<std::pair<int, int>> places;
    for (int y = kReach_px; y + kReach_px < white.height; ++y)
        for (int x = kReach_px; x + kReach_px < white.width; ++x)
            if (!spoilt[white.index(x, y)] && lit(white.index(x, y)) && lit(white.index(x - kReach_px, y)) &&
                lit(white.index(x + kReach_px, y)) && lit(white.index(x, y - kReach_px)) &&
                lit(white.index(x, y + kReach_px)))
                places.emplace_back(x, y);
    const std::size_t every = 1 + places.size() / kMostPixels;
    for (std::size_t k = 0; k < places.size(); k += every) {
        const auto [x, y] = places[k];
        const float dx = 0.5F * (pictures_.even_at(first, x + 1, y) - pictures_.even_at(first, x - 1, y)),
                    dy = 0.5F * (pictures_.even_at(first, x, y + 1) - pictures_.even_at(first, x, y - 1));
        if (std::hypot(dx, dy) > kSteepest) continue;
        pixels_.push_back({x, y, 0, pictures_.even_at(first, x, y), dx, dy, light_at(white.index(x, y))});
    }
}

Surface::Row Surface::by_numbers(const Pixel& p) const {
    const double u = (p.x - centre_.x()) / scale_, v = (p.y - centre_.y()) / scale_;
    Row J;
    J << p.dx, p.dx * u, p.dx * v, p.dy, p.dy * u, p.dy * v, -p.light;
    return J;
}

/// Without doubt, and so far around that no edge of a stripe is near.
bool Surface::is_lit(const Pixel& p, const Moment& moment) const {
    const GrayImage &frame = pictures_.frames[moment.frames.front()], &white = pictures_.frames[pictures_.white],
                    &black = pictures_.frames[pictures_.black];
    const auto lit = [&](int x, int y) {
        const std::size_t i = frame.index(x, y);
        const float dark = pictures_.light[black.pixels[i]];
        return pictures_.light[frame.pixels[i]] - dark > 0.75F * (pictures_.light[white.pixels[i]] - dark);
    };
    return lit(p.x, p.y) && lit(p.x - kReach_px, p.y) && lit(p.x + kReach_px, p.y) && lit(p.x, p.y - kReach_px) &&
           lit(p.x, p.y + kReach_px);
}

Laid Surface::lay(const Moment& later) const {
    Laid laid;
    std::vector<Row> rows;
    std::vector<float> differences;
    std::vector<int> patch;
    Normal A = Normal::Zero();
    for (const Pixel& p : pixels_) {
        if (later.lit_only && !is_lit(p, later)) continue;
        rows.push_back(by_numbers(p));
        differences.push_back(p.first - pictures_.even_at(later, p.x, p.y));
        patch.push_back(p.patch);
        A.selfadjointView<Eigen::Lower>().rankUpdate(rows.back());
    }
    if (rows.size() < kLeastPixels) return laid;
    const Numbers weights = A.diagonal().cwiseMax(1e-12).cwiseSqrt().cwiseInverse();
    const Normal scaled = weights.asDiagonal() * Normal(A.selfadjointView<Eigen::Lower>()) * weights.asDiagonal();
    const Eigen::LDLT<Normal> normal(scaled);
    if (normal.vectorD().minCoeff() < 1e-9) return laid;
    Numbers numbers = Numbers::Zero();
    std::vector<Numbers> scores(static_cast<std::size_t>(patches_));
    for (const double huber_grey :
         {1e9, 24.0, 12.0, 12.0}) {  // what fits no map (an edge, a hand) has less and less weight
        std::fill(scores.begin(), scores.end(), Numbers::Zero());
        for (std::size_t k = 0; k < rows.size(); ++k) {
            const double r = static_cast<double>(differences[k]) - rows[k].dot(numbers);
            scores[static_cast<std::size_t>(patch[k])] += rows[k] * std::clamp(r, -huber_grey, huber_grey);
        }
        Numbers sum = Numbers::Zero();
        for (const Numbers& score : scores) sum += score;
        const Numbers step = weights.asDiagonal() * normal.solve(weights.asDiagonal() * sum);
        numbers += step;
    }
    Normal scatter = Normal::Zero();
    for (const Numbers& score : scores) {
        const Numbers s = weights.asDiagonal() * normal.solve(weights.asDiagonal() * score);
        scatter += s * s.transpose();
    }
    std::sort(patch.begin(), patch.end());
    const auto patches = static_cast<int>(std::unique(patch.begin(), patch.end()) - patch.begin());
    if (patches < 2 * kNumbers) return laid;  // too few to tell how they scatter
    laid.map = numbers.head<kAffine>();
    laid.covariance = scatter.topLeftCorner<kAffine, kAffine>() * (static_cast<double>(patches) / (patches - kNumbers));
    laid.determined = true;
    return laid;
}

Surface::Way Surface::between(const Laid& a, const Laid& b) const {
    const Affine d = a.map - b.map;
    const Eigen::Matrix<double, kAffine, kAffine> covariance = a.covariance + b.covariance;
    std::vector<double> ways;
    double variance = 0;
    for (std::size_t k = 0; k < pixels_.size(); k += 1 + pixels_.size() / 500) {
        const double u = (pixels_[k].x - centre_.x()) / scale_, v = (pixels_[k].y - centre_.y()) / scale_;
        Eigen::Matrix<double, 2, kAffine> P;
        P << 1, u, v, 0, 0, 0, 0, 0, 0, 1, u, v;
        ways.push_back((P * d).norm());
        variance += (P * covariance * P.transpose()).trace();
    }
    const auto at = ways.begin() + static_cast<std::ptrdiff_t>(ways.size() * 95 / 100);
    std::nth_element(ways.begin(), at, ways.end());
    return {*at, std::sqrt(variance / static_cast<double>(ways.size()))};
}

}  // namespace planlight::affine_movement
