#pragma once

#include "planning_io/types/point_cloud.h"
#include "planning_io/types/rigid_transform.h"
#include "planning_io/types/skin_lut.h"

namespace planlight {

/// Of the ICP on the table.
struct IcpSettings {
    enum class Mode {
        signed_distance,  ///< point to plane on the trilinear signed distance, annealed robust weights (default)
        closest_point,    ///< the paper's: point to the skin point behind the table's pointer (Besl & McKay 1992)
    } mode = Mode::signed_distance;
    int max_iterations = 0;                          ///< 0: 60, and 300 for closest points, which crawl
    double first_scale_mm = 5, last_scale_mm = 0.5;  ///< of the robust weight, annealed
    double max_pair_mm = 15;                         ///< a point farther from the skin takes no part
    double stop_mm = 1e-4;                           ///< largest movement of a point in the last step
    int max_points = 20000;
};

/// The refined pose and how it was reached.
struct IcpResult {
    RigidTransform ct_from_rig = RigidTransform::Identity();
    int iterations = 0;
    bool converged = false;
    std::size_t inliers = 0, used = 0;  ///< points within 3 last scales; points that took part
    double residual_rms_mm = 0;         ///< of the inliers
    double residual_median_mm = 0;      ///< of all points
    Eigen::Matrix<double, 6, 6> information =
        Eigen::Matrix<double, 6, 6>::Zero();  ///< sum w J^T J about `centre_in_ct`
    Eigen::Vector3d centre_in_ct = Eigen::Vector3d::Zero();
};

/// Fine tuning with the LUT as table of closest points (Hoppe 2001, 2.2). Seals and cut planes take no part.
IcpResult refine_icp(const PointCloud& cloud, const SkinLut& lut, const RigidTransform& ct_from_rig,
                     const IcpSettings& settings = {});

}  // namespace planlight
