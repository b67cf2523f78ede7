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

/// The same for half a turn about the third axis of ct alone, which exchanges LPS and RAS.
std::optional<Alternative> half_turned(const std::vector<Eigen::Vector3d>& points_on_skin_in_ct,
                                       const SkinSurface& skin);

/// Whether there are points enough, and far enough apart, for a copy that fits to say anything.
bool tells_by_copies(const std::vector<Eigen::Vector3d>& points_on_skin_in_ct);

/// Whether all of it lies within 60 mm, and under the skin at about one depth, as what was planned on bone does: a copy
/// that fits may do so by chance.
bool small_and_even(const std::vector<Eigen::Vector3d>& points_on_skin_in_ct, const SkinSurface& skin);

/// How deep points lie under the skin, mm; negative over it.
struct DepthRange {
    double least_mm = 0, most_mm = 0;
    double spread_mm() const { return most_mm - least_mm; }
};

/// A plan that was taken for the other of LPS and RAS: half a turn about the axis from foot to head.
struct OtherSpace {
    DepthRange as_given, turned;
    std::size_t places = 0;  ///< that lie 10 mm apart or more
};

/// Given where the plan lies unevenly deep, and half a turn about the third axis of ct would bring all of it to one
/// depth: what was planned on skin or on bone lies evenly, wherever that is. Of three places or more, 30 mm across.
std::optional<OtherSpace> fits_in_other_space(const std::vector<Eigen::Vector3d>& points_on_skin_in_ct,
                                              const SkinSurface& skin);

/// The share-th smallest of the distances from the skin, mm. `points` must not be empty.
double distance_quantile(const std::vector<Eigen::Vector3d>& points, const SkinSurface& skin, double share);

}  // namespace planlight
