#pragma once

#include <string>
#include <vector>

#include "planning_io/types/point_cloud.h"
#include "planning_io/types/pose_covariance.h"
#include "planning_io/types/rigid_transform.h"
#include "planning_io/types/skin_lut.h"

namespace planlight {

/// How the whole cloud lies on the skin. A point whose nearest skin is a seal or the end of the volume is unknown.
struct CloudOnSkin {
    std::size_t points = 0;   ///< finite ones
    std::size_t known = 0;    ///< of these, judged
    std::size_t inliers = 0;  ///< nearer than the inlier distance, facing the same way as the skin
    std::size_t inside = 0;   ///< deeper in the body than that, where no light comes from
    double inlier_rms_mm = 0;
    /// The same without what neighbouring points differ by among themselves, which is the scan's own noise: how far the
    /// surfaces lie apart. Of cells of 6 mm.
    double shape_rms_mm = 0;
    double median_mm = 0;  ///< of the known ones, absolute
    double inlier_fraction() const {
        return known == 0 ? 0 : static_cast<double>(inliers) / static_cast<double>(known);
    }
    double inside_fraction() const { return known == 0 ? 0 : static_cast<double>(inside) / static_cast<double>(known); }
    double known_fraction() const { return points == 0 ? 0 : static_cast<double>(known) / static_cast<double>(points); }
};
/// Distances are counted from `skin_offset_mm` outside of the CT's skin.
CloudOnSkin lay_on_skin(const PointCloud& cloud, const SkinLut& lut, const RigidTransform& ct_from_rig,
                        double inlier_distance_mm, double skin_offset_mm = 0);

/// The way in which the patient could move with the least change of the residuals.
struct WeakestWay {
    double sigma_mm =
        0;  ///< one standard deviation of the movement 80 mm from the scan's centre; infinite when nothing is known
    std::string in_words;  ///< "turn about the head-foot axis"
    std::string advice;    ///< what a further scan should show: "the bridge of the nose or an ear"
};

/// The direction of the largest variance, in words.
WeakestWay weakest_way(const PoseCovariance& covariance);

/// Standard deviations along the cloud's principal axes times sqrt(12): the extents of an even slab; largest first.
/// Finite points within 3 median distances of the median only.
Eigen::Vector3d extents_mm(const PointCloud& cloud);

/// The cloud as its mirror image (x -> -x).
PointCloud mirrored(const PointCloud& cloud);

}  // namespace planlight
