#include "projection/plan_alternatives.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

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

}  // namespace

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

std::optional<Alternative> best_alternative(const std::vector<Vector3d>& points, const SkinSurface& skin,
                                            const Vector3d& centre) {
    const auto some = thinned(points);
    if (some.size() < kFewestPoints || span_mm(some) < kLeastSpan_mm) return std::nullopt;
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
