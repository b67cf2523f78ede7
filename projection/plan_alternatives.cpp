#include "projection/plan_alternatives.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "projection/check_items.h"

namespace planlight {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr std::size_t kFewestPoints = 4, kMostPoints = 60;
constexpr double kLeastSpan_mm = 20;

std::string words_of(const Matrix3d& axes) {
    std::array<std::string, 3> read;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            if (axes(row, column) != 0)
                read[static_cast<std::size_t>(row)] = std::string(axes(row, column) < 0 ? "-" : "") + "xyz"[column];
    return fmt::format("(x, y, z) read as ({}, {}, {})", read[0], read[1], read[2]);
}

std::vector<Vector3d> thinned(const std::vector<Vector3d>& points) {
    std::vector<Vector3d> some;
    const std::size_t step = points.size() / kMostPoints + 1;
    for (std::size_t i = 0; i < points.size(); i += step) some.push_back(points[i]);
    return some;
}

double span_mm(const std::vector<Vector3d>& points) {
    double most = 0;
    for (const auto& a : points)
        for (const auto& b : points) most = std::max(most, (a - b).norm());
    return most;
}

/// Each 10 mm from those before it: neighbours on a line tell nothing new.
std::vector<Vector3d> places_apart(const std::vector<Vector3d>& points) {
    constexpr double kApart_mm = 10;
    std::vector<Vector3d> places;
    for (const Vector3d& p : points) {
        if (places.size() == kMostPoints) break;
        if (std::ranges::none_of(places, [&](const Vector3d& q) { return (p - q).norm() < kApart_mm; }))
            places.push_back(p);
    }
    return places;
}

DepthRange depths_of(const std::vector<Vector3d>& points, const SkinSurface& skin) {
    DepthRange range{1e9, -1e9};
    for (const Vector3d& p : points) {
        const double off_mm = (skin.nearest(p).p_in_ct - p).norm(), depth_mm = in_the_body(skin, p) ? off_mm : -off_mm;
        range.least_mm = std::min(range.least_mm, depth_mm);
        range.most_mm = std::max(range.most_mm, depth_mm);
    }
    return range;
}

}  // namespace

std::optional<OtherSpace> fits_in_other_space(const std::vector<Vector3d>& points, const SkinSurface& skin) {
    constexpr std::size_t kFewest = 3;
    constexpr double kAcross_mm = 30, kEven_mm = 2.5, kTimes = 3, kFinest_mm = 1, kDeepest_mm = 15, kHighest_mm = 2;
    std::vector<Vector3d> places = places_apart(points);
    if (places.size() < kFewest || span_mm(places) < kAcross_mm) return std::nullopt;
    OtherSpace found{depths_of(places, skin), {}, places.size()};
    if (found.as_given.spread_mm() < kTimes * kFinest_mm) return std::nullopt;
    for (Vector3d& p : places) p = Vector3d(-p.x(), -p.y(), p.z());
    found.turned = depths_of(places, skin);
    const bool even = found.turned.spread_mm() <= kEven_mm &&
                      found.as_given.spread_mm() >= kTimes * std::max(found.turned.spread_mm(), kFinest_mm);
    if (!even || found.turned.most_mm > kDeepest_mm || found.turned.least_mm < -kHighest_mm) return std::nullopt;
    return found;
}

std::vector<Matrix3d> axis_permutations_and_flips() {
    std::vector<Matrix3d> all;
    std::array<int, 3> order{0, 1, 2};
    do {
        for (int flips = 0; flips < 8; ++flips) {
            Matrix3d m = Matrix3d::Zero();
            for (int row = 0; row < 3; ++row)
                m(row, order[static_cast<std::size_t>(row)]) = (flips >> row) & 1 ? -1 : 1;
            all.push_back(m);
        }
    } while (std::next_permutation(order.begin(), order.end()));
    return all;
}

double distance_quantile(const std::vector<Vector3d>& points, const SkinSurface& skin, double share) {
    std::vector<double> far;
    for (const auto& p : points) far.push_back((skin.nearest(p).p_in_ct - p).norm());
    const auto at =
        far.begin() + static_cast<std::ptrdiff_t>(
                          std::min(far.size() - 1, static_cast<std::size_t>(share * static_cast<double>(far.size()))));
    std::nth_element(far.begin(), at, far.end());
    return *at;
}

bool tells_by_copies(const std::vector<Vector3d>& points) {
    const auto some = thinned(points);
    return some.size() >= kFewestPoints && span_mm(some) >= kLeastSpan_mm;
}

bool small_and_even(const std::vector<Vector3d>& points, const SkinSurface& skin) {
    constexpr double kAcross_mm = 60, kEven_mm = 2.5, kHighest_mm = 1, kDeepest_mm = 15;
    const std::vector<Vector3d> some = thinned(points);
    if (span_mm(some) > kAcross_mm) return false;
    const DepthRange range = depths_of(some, skin);
    return range.spread_mm() <= kEven_mm && range.least_mm >= -kHighest_mm && range.most_mm <= kDeepest_mm;
}

std::optional<Alternative> half_turned(const std::vector<Vector3d>& points, const SkinSurface& skin) {
    if (!tells_by_copies(points)) return std::nullopt;
    const Matrix3d axes = Vector3d(-1, -1, 1).asDiagonal();
    std::vector<Vector3d> copy = thinned(points);
    for (Vector3d& p : copy) p = axes * p;
    return Alternative{axes, words_of(axes), distance_quantile(copy, skin, 0.9)};
}

std::optional<Alternative> best_alternative(const std::vector<Vector3d>& points, const SkinSurface& skin,
                                            const Vector3d& centre) {
    if (!tells_by_copies(points)) return std::nullopt;
    const auto some = thinned(points);
    std::optional<Alternative> best;
    const auto all = axis_permutations_and_flips();
    for (std::size_t i = 1; i < all.size(); ++i)
        for (const bool about_centre : {false, true}) {
            const Vector3d about = about_centre ? centre : Vector3d::Zero();
            std::vector<Vector3d> copy;
            for (const auto& p : some) copy.push_back(all[i] * (p - about) + about);
            const double fit = distance_quantile(copy, skin, 0.9);
            if (!best || fit < best->fit_mm)
                best = Alternative{all[i], words_of(all[i]) + (about_centre ? " about the middle of the volume" : ""),
                                   fit};
        }
    return best;
}

}  // namespace planlight
