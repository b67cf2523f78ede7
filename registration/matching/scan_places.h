#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <vector>

#include "registration/matching/measure_displacement.h"

// A scan gathered into places of the CT's skin. Private to registration/matching.
namespace planlight {

/// Where a point of the scan stands over the CT's skin.
struct Foot {
    Eigen::Vector3d on_skin_in_ct;
    double mm;  ///< outside
};

/// Of the points that face as the skin does, and lie less than so far inside and outside of it. Signed distances are to
/// the tangent plane of the nearest point of the table: it is exact on flat skin and off by 0.01 mm at a radius of
/// 20 mm, where the coarse distance field cuts corners.
std::vector<Foot> feet_of(const PointCloud& cloud, const SkinLut& lut, const RigidTransform& ct_from_rig,
                          double facing_cosine, double most_inside_mm, double most_outside_mm);

/// A cube of the CT that holds skin.
using SkinCell = std::array<int, 3>;
SkinCell cell_of(const Eigen::Vector3d& p_in_ct, double edge_mm);

/// The scan's points over the skin in one cell.
struct Gathered {
    Eigen::Vector3d sum_in_ct = Eigen::Vector3d::Zero();
    std::vector<double> distances_mm;
};
std::map<SkinCell, Gathered> gather(const std::vector<Foot>& feet, double edge_mm);

/// Median absolute deviation of a Gaussian -> its sigma.
inline constexpr double kSigmaOfMad = 1.4826;

/// Their mean and the median of their distances, with its sigma: `least_sigma_mm` is what all of them share.
SkinDisplacement::Place place_of(const Gathered& gathered, double least_sigma_mm);

}  // namespace planlight
