#pragma once

#include "planning_io/types/point_cloud.h"
#include "planning_io/types/pose_covariance.h"
#include "planning_io/types/rigid_transform.h"
#include "planning_io/types/skin_lut.h"

namespace planlight {

/// How the skin may have moved over the bone.
struct DeformableSettings {
    int max_patches = 240;       ///< the scan is gathered into at most about this many patches of equal size
    int steps = 3;               ///< each from where the one before led
    double offset_prior_mm = 1;  ///< how far the whole skin may lie outside or inside of the CT's, one sigma
    /// How uneven that may be over the directions the skin faces, one sigma, as a share of it: another threshold moves
    /// skin by the width of its edge, and a CT is blurred more along its slices than in them. More (0.7) leaves the
    /// pose of a face seen from the front next to free along the line of sight.
    double uneven_share = 0.2;
    double caution = 3;         ///< on the variance: no skin is quite a Gaussian field of one length
    double pulled_share = 0.8;  ///< of the movement seen: how far skin may be pulled along unseen, one sigma
    double offset_share = 0.3;  ///< the same, of the offset
    /// Skin is taken to move in proportion to its thickness over the bone and this much, where the table knows the
    /// thickness; infinite: alike everywhere.
    double thickness_floor_mm = 5;
    double least_movement_mm = 0.1;  ///< that no residual could show, one sigma
    /// A shift of the whole that no residual shows even where the skin is still: another threshold or light that enters
    /// the skin looks like a head that lies a little deeper. One sigma.
    double least_shift_mm = 0.25;
};

/// The pose of a scan of skin that has moved since the CT, and how sure it is.
struct DeformablePose {
    RigidTransform ct_from_rig = RigidTransform::Identity();
    PoseCovariance
        covariance;          ///< infinite when the scan holds too little skin to tell; the pose is then the one given
    double movement_mm = 0;  ///< of the skin along its normal, rms
    double correlation_mm = 0;  ///< over which the movement is alike
    double offset_mm = 0;       ///< of the whole skin; positive outside of the CT's
    double scale = 1;           ///< by which the scan would have to grow to fit best
    double scale_sigma = 0;     ///< one standard deviation of that
    int patches = 0;
    bool known() const { return covariance.of_turn_and_shift.allFinite(); }
};

/// The last step of the fine match: from a pose that is right to about a millimetre.
///
/// Skin moves between CT and operation by a field along its normal that is alike over some length (a Gaussian process),
/// by an offset of the whole (another threshold, swelling all over; a threshold moves skin more where the voxels are
/// long), and by a part of each patch's own. Pose and offset are found by generalised least squares under that field.
/// How far the skin moved and over what length it is alike is not assumed: the residuals of the patches tell it by
/// restricted maximum likelihood (Patterson & Thompson 1971), which does not count what the pose has taken up; all
/// plausible fields are averaged by their likelihood. The usual sigma^2 (J^T J)^-1 takes the residuals of neighbours
/// for independent, and is over-confident by an order.
///
/// What no residual can show is added: skin that is pulled along as a whole, in proportion to the movement and the
/// offset that are seen. The shares were set on three models of movement; the bound is measured on others
/// (registration/matching/ACCURACY.md).
DeformablePose refine_pose_deformable(const PointCloud& cloud, const SkinLut& lut, const RigidTransform& ct_from_rig,
                                      const DeformableSettings& settings = {});

}  // namespace planlight
