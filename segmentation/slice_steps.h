#pragma once

#include <Eigen/Core>
#include <optional>

#include "planning_io/types/volume.h"
#include "segmentation/segment_skin.h"
#include "segmentation/skin_shape.h"

namespace planlight {

/// Where the outline of the head jumps from one slice to the next, as it does when the patient moved between them.
struct SliceStep {
    Eigen::Vector3d place_in_ct = Eigen::Vector3d::Zero();   ///< the head's middle between the two slices
    Eigen::Vector3d normal_in_ct = Eigen::Vector3d::Zero();  ///< of the slices, unit
    Eigen::Vector3d shift_in_ct = Eigen::Vector3d::Zero();   ///< of what comes after, mm, within the slice
    double shift_mm = 0;
    double turn = 0;      ///< the same, radians about the slices' normal
    double jump_mm = 0;   ///< rms of the outline's jump, by shift and turn together
    double usual_mm = 0;  ///< the same between the other slices, median
};

/// The largest step between neighbouring slices of the volume, across each of its three axes; empty where no step
/// stands out. What jumps is the whole outline, as a shift and a turn of it explain: an ear or a nose that begins moves
/// a part of it. Asked of the upper 150 mm (`ball`: the largest in the head), without the two slices at either end of
/// it. A movement along the slices' normal does not show, nor does one that the volume was turned after.
std::optional<SliceStep> largest_slice_step(const Volume& volume, const SkinMask& mask, const HeadBall& ball);

}  // namespace planlight
