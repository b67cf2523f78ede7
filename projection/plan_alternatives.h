#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "projection/check_plan.h"

namespace planlight {

/// The 48 ways to exchange and flip the three axes; the first is the identity.
std::vector<Eigen::Matrix3d> axis_permutations_and_flips();

/// A copy of the plan with exchanged or flipped axes.
struct Alternative {
    Eigen::Matrix3d axes;
    std::string words;  ///< "(x, y, z) read as (-x, -y, z)", and about what
    double fit_mm = 0;  ///< 90 % of its points lie this near to the skin
};

/// Of all copies of the plan with exchanged and flipped axes, about the origin and about `centre_in_ct` (of the
/// volume), the one that fits the skin best. Empty when the plan has fewer than four points, or they span less than 20
/// mm: a few points fit somewhere by chance.
std::optional<Alternative> best_alternative(const std::vector<Eigen::Vector3d>& points_on_skin_in_ct,
                                            const SkinSurface& skin, const Eigen::Vector3d& centre_in_ct);

/// The share-th smallest of the distances from the skin, mm. `points` must not be empty.
double distance_quantile(const std::vector<Eigen::Vector3d>& points, const SkinSurface& skin, double share);

}  // namespace planlight
