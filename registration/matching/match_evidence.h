#pragma once

#include <string>
#include <vector>

#include "planning_io/types/point_cloud.h"
#include "planning_io/types/skin_lut.h"
#include "registration/matching/refine_icp.h"

namespace planlight {

/// How the whole cloud lies on the skin. A point whose nearest skin is a seal or the end of the volume is unknown.
struct CloudOnSkin {
    std::size_t points = 0;   ///< finite ones
    std::size_t known = 0;    ///< of these, judged
    std::size_t inliers = 0;  ///< nearer than the inlier distance, facing the same way as the skin
    double inlier_rms_mm = 0;
    double median_mm = 0;     ///< of the known ones, absolute
    double inlier_fraction() const { return known == 0 ? 0 : static_cast<double>(inliers) / static_cast<double>(known); }
    double known_fraction() const { return points == 0 ? 0 : static_cast<double>(known) / static_cast<double>(points); }
};
CloudOnSkin lay_on_skin(const PointCloud& cloud, const SkinLut& lut, const RigidTransform& ct_from_rig, double inlier_distance_mm);

/// The way in which the patient could move with the least change of the residuals.
struct WeakestWay {
    double sigma_mm = 0;      ///< one standard deviation of a point 80 mm from the scan's centre
    double deformation_mm = 0; ///< the movement of the skin that it was predicted from
    std::string in_words;     ///< "turn about the head-foot axis"
    Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();  ///< of (rotation, translation of the centre)
};

/// Predicted from the skin's own movement since the CT: a field normal to the skin of `deformation_mm` that is alike within
/// `correlation_mm`, instead of independent noise, which is over-confident by an order (the sums then divide by the
/// number of points). H^-1 [sum_ij w_i w_j J_i J_j^T k(x_i, x_j)] H^-1. When the residuals, averaged over that distance,
/// show more movement than `least_deformation_mm`, that is taken.
WeakestWay weakest_way(const PointCloud& cloud, const SkinLut& lut, const IcpResult& icp, double least_deformation_mm,
                       double correlation_mm);

/// The factor by which the scan should shrink or grow to fit best (1 when it fits as it is): another patient, or a rig
/// whose calibration has the wrong scale.
double best_scale(const PointCloud& cloud, const SkinLut& lut, const IcpResult& icp);

/// Standard deviations along the cloud's principal axes times sqrt(12): the extents of an even slab; largest first.
/// Finite points within 3 median distances of the median only.
Eigen::Vector3d extents_mm(const PointCloud& cloud);

/// The cloud as its mirror image (x -> -x).
PointCloud mirrored(const PointCloud& cloud);

}  // namespace planlight
