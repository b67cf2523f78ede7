#include "registration/scan/movement/affine_movement.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "planning_io/types/statistics.h"
#include "registration/scan/check/picture_noise.h"

namespace planlight::affine_movement {
namespace {

constexpr int kReach_px = 4;  // a pixel is used where all is lit so far around it
// Slopes of means of 3 x 3 pixels are asked at kReach_px - 1 beside it, so this far it keeps from the picture's rim.
constexpr int kRim_px = kReach_px + 1;
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

float Pictures::mean_at(std::size_t frame, int x, int y) const {
    const GrayImage& picture = frames[frame];
    float sum = 0;
    for (int dy = -1; dy <= 1; ++dy) {
        const std::uint8_t* p = &picture.pixels[picture.index(x, y + dy)];
        sum += light[p[-1]] + light[p[0]] + light[p[1]];
    }
    return sum / 9;
}

float Pictures::even_at(const Moment& moment, int x, int y) const {
    if (moment.lit_only) return mean_at(moment.frames.front(), x, y) + mean_at(black, x, y);
    float sum = 0;
    for (std::size_t k = 0; k < moment.frames.size(); ++k)
        sum += (moment.weights.empty() ? 1 : moment.weights[k]) * mean_at(moment.frames[k], x, y);
    return sum * 2 / static_cast<float>(moment.frames.size());
}

Surface::Surface(const Pictures& pictures, const Moment& first, const std::vector<Moment>& moments)
    : pictures_(pictures), first_(first) {
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
    across_ = across_pixels();
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
    for (int y = kRim_px; y + kRim_px < white.height; ++y)
        for (int x = kRim_px; x + kRim_px < white.width; ++x)
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
        pixels_.push_back({x, y, 0, pictures_.even_at(first, x, y), dx, dy, light_at(white.index(x, y)),
                           pictures_.mean_at(pictures_.black, x, y)});
    }
    // A camera's own black is no light of a room, nor is its noise; of little light a tenth is nothing.
    constexpr double kLeastRoom_grey = 6;
    std::vector<double> room;
    for (const Pixel& p : pixels_) room.push_back(static_cast<double>(p.room));
    const double least = quantile(room, 0.05), most = quantile(std::move(room), 0.95);
    for (Pixel& p : pixels_)
        p.room = most - least < kLeastRoom_grey ? 0 : std::max(0.0F, p.room - static_cast<float>(least));
}

Surface::AcrossPixels Surface::across_pixels() const {
    constexpr std::size_t kMost = 10000;
    constexpr int kSide_px = kReach_px - 1;  // the means of 3 x 3 pixels there are lit as well
    AcrossPixels across;
    const std::size_t every = 1 + pixels_.size() / kMost;
    for (std::size_t i = 0; i < pixels_.size(); i += every)
        for (const auto& [dx, dy] : {std::pair(kSide_px, 0), std::pair(0, kSide_px)}) {
            const Pixel& p = pixels_[i];
            across.pairs.push_back({p.x - dx, p.y - dy, p.x + dx, p.y + dy});
        }
    const auto n = static_cast<Eigen::Index>(across.pairs.size());
    across.first.resize(n);
    across.slopes.resize(n, kAffine);
    for (Eigen::Index i = 0; i < n; ++i) {
        const AcrossPixels::Pair& at = across.pairs[static_cast<std::size_t>(i)];
        const auto even = [&](int x, int y) { return pictures_.even_at(first_, x, y); };
        const auto slopes = [&](int x, int y) {
            return by_map(x, y, 0.5 * (even(x + 1, y) - even(x - 1, y)), 0.5 * (even(x, y + 1) - even(x, y - 1)));
        };
        across.first[i] = even(at.x1, at.y1) - even(at.x0, at.y0);
        across.slopes.row(i) = (slopes(at.x1, at.y1) - slopes(at.x0, at.y0)).transpose();
    }
    return across;
}

Moment Surface::steadied(Moment moment) const {
    if (moment.lit_only || moment.frames.size() < 2 || pixels_.empty()) return moment;
    constexpr double kUsual = 0.1;  // lamps change by this much, one standard deviation
    const auto frames = static_cast<Eigen::Index>(moment.frames.size()), n = across_.first.size();
    const float scale = 2 / static_cast<float>(frames);
    // Fringes of a projector that is not linear are not half as bright as white; a bit and its inverse are white.
    const Eigen::Index brightness = frames > 2 ? 1 : 0;
    // By how much each frame but the last counts more, which the last counts less; then how much brighter they are.
    Eigen::MatrixXd rows(n, frames - 1 + brightness + kAffine);
    Eigen::VectorXd left = across_.first;
    for (Eigen::Index i = 0; i < n; ++i) {
        const AcrossPixels::Pair& at = across_.pairs[static_cast<std::size_t>(i)];
        const auto difference = [&](Eigen::Index k) {
            const std::size_t frame = moment.frames[static_cast<std::size_t>(k)];
            return scale * (pictures_.mean_at(frame, at.x1, at.y1) - pictures_.mean_at(frame, at.x0, at.y0));
        };
        const float last = difference(frames - 1);
        left[i] -= last;
        for (Eigen::Index k = 0; k + 1 < frames; ++k) {
            rows(i, k) = difference(k);
            left[i] -= rows(i, k);
            rows(i, k) -= last;
        }
        if (brightness > 0) rows(i, frames - 1) = across_.first[i] - left[i];
    }
    rows.rightCols<kAffine>() = across_.slopes;
    Eigen::VectorXd found = Eigen::VectorXd::Zero(rows.cols()), prior = found;
    prior.head(frames - 1).setConstant(1 / (kUsual * kUsual));  // of a movement there is none
    if (brightness > 0) prior[frames - 1] = 1;                  // it may be anything
    for (int round = 0; round < 3; ++round) {                   // edges that have moved, glints: less and less weight
        const Eigen::VectorXd now = left - rows * found;
        std::vector<double> sizes(now.data(), now.data() + now.size());
        for (double& size : sizes) size = std::abs(size);
        const double sigma = std::max(0.1, 1.4826 * median(std::move(sizes)));
        const Eigen::VectorXd trust = now.unaryExpr(
            [&](double r) { return std::min(1.0, 2 * sigma / std::max(1e-9, std::abs(r))) / (sigma * sigma); });
        Eigen::MatrixXd normal = rows.transpose() * trust.asDiagonal() * rows;
        normal.diagonal() += prior;
        found += normal.ldlt().solve(rows.transpose() * trust.asDiagonal() * now - prior.cwiseProduct(found));
    }
    // Less than this leaves no more of a stripe than a camera's noise.
    constexpr double kLeast = 0.004;
    const Eigen::VectorXd more = found.head(frames - 1);
    if (std::max(more.cwiseAbs().maxCoeff(), std::abs(more.sum())) < kLeast) return moment;
    for (const double by : more) moment.weights.push_back(static_cast<float>(1 + by));
    moment.weights.push_back(static_cast<float>(1 - more.sum()));
    return moment;
}

Surface::Row Surface::by_numbers(const Pixel& p) const {
    Row J;
    J << by_map(p.x, p.y, p.dx, p.dy), -p.light, -p.room;
    return J;
}

Affine Surface::by_map(int x, int y, double dx, double dy) const {
    const double u = (x - centre_.x()) / scale_, v = (y - centre_.y()) / scale_;
    return Affine{{dx, dx * u, dx * v, dy, dy * u, dy * v}};
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
    const auto lit_at = [&](int x, int y) {
        return x >= 0 && y >= 0 && x < frame.width && y < frame.height && lit(x, y);
    };
    for (const int px : {kReach_px, moment.clear_px})
        if (!lit_at(p.x - px, p.y) || !lit_at(p.x + px, p.y) || !lit_at(p.x, p.y - px) || !lit_at(p.x, p.y + px))
            return false;
    return lit(p.x, p.y);
}

Laid Surface::lay(const Moment& later) const {
    Laid laid;
    std::vector<Row> rows;
    std::vector<float> differences;
    std::vector<int> patch;
    Normal A = Normal::Zero();
    if (later.lit_only) laid.seen.assign(pixels_.size(), false);
    for (std::size_t k = 0; k < pixels_.size(); ++k) {
        const Pixel& p = pixels_[k];
        if (later.lit_only && !is_lit(p, later)) continue;
        if (later.lit_only) laid.seen[k] = true;
        rows.push_back(by_numbers(p));
        differences.push_back(p.first - pictures_.even_at(later, p.x, p.y));
        patch.push_back(p.patch);
        A.selfadjointView<Eigen::Lower>().rankUpdate(rows.back());
    }
    if (rows.size() < kLeastPixels) return laid;
    // A room's light changes by a tenth (one sigma), and a grey value scatters by two: of little of it little is told.
    constexpr double kRoom = 4 / (0.1 * 0.1);
    A(kNumbers - 1, kNumbers - 1) += kRoom;
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
        sum[kNumbers - 1] -= kRoom * numbers[kNumbers - 1];
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
    // Where projector and room light alike, which of them changed is not told: only both together.
    double changed = 0, light = 0;
    for (const Row& row : rows) {
        changed -= row.tail<2>().dot(numbers.tail<2>());
        light -= row[kAffine];
    }
    laid.light_change = changed / std::max(light, 1.0);
    for (const float weight : later.weights)
        laid.uneven_light = std::max(laid.uneven_light, std::abs(static_cast<double>(weight) - 1));
    laid.determined = true;
    return laid;
}

std::optional<Surface::Way> Surface::between(const Laid& a, const Laid& b) const {
    const Affine d = a.map - b.map;
    const Eigen::Matrix<double, kAffine, kAffine> covariance = a.covariance + b.covariance;
    const auto looked_at = [](const Laid& laid, std::size_t k) { return laid.seen.empty() || laid.seen[k]; };
    std::vector<double> ways;
    double variance = 0;
    std::size_t all = 0;
    for (std::size_t k = 0; k < pixels_.size(); k += 1 + pixels_.size() / 1000) {
        ++all;
        if (!looked_at(a, k) || !looked_at(b, k)) continue;
        const double u = (pixels_[k].x - centre_.x()) / scale_, v = (pixels_[k].y - centre_.y()) / scale_;
        Eigen::Matrix<double, 2, kAffine> P;
        P << 1, u, v, 0, 0, 0, 0, 0, 0, 1, u, v;
        ways.push_back((P * d).norm());
        variance += (P * covariance * P.transpose()).trace();
    }
    if (10 * ways.size() < all) return std::nullopt;
    const auto at = ways.begin() + static_cast<std::ptrdiff_t>(ways.size() * 95 / 100);
    std::nth_element(ways.begin(), at, ways.end());
    return Way{*at, std::sqrt(variance / static_cast<double>(ways.size()))};
}

}  // namespace planlight::affine_movement
