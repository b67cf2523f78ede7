#pragma once

#include "planning_io/types/image.h"
#include "planning_io/types/plan.h"
#include "planning_io/types/triangle_mesh.h"
#include "planning_io/types/volume.h"

namespace planlight {

/// Which axis of ct a slice lies across, with the picture's sides as radiologists have them: axial seen from the feet
/// (R left, A up), coronal from the front (R left, S up), sagittal from the patient's left (A left, S up).
enum class SliceKind { axial, coronal, sagittal };

/// How a slice of the volume is shown.
struct SliceSettings {
    int width = 640, height = 640;  ///< pixels
    double plan_within_mm = 3;      ///< plan lines this near to the slice are drawn on it
    double low = 0,
           high = 0;  ///< values shown black and white; both 0 = -800 to 800 HU, else the 1st to 99.5th percentile
};

/// A slice of the volume (resampled trilinearly through its whole affine, so that a tilt or an oblique MR stands as the
/// patient does) through `p_in_ct`, with the line in which it cuts the skin mesh (seals amber, ends of the volume
/// grey), the plan near it (of holes those with an axis), and R L A P S I at the sides. What is outside the volume is
/// dark blue. Skin and plan may be empty.
RgbImage slice_picture(const Volume& volume, const TriangleMesh& skin, const Plan& plan, SliceKind kind,
                       const Eigen::Vector3d& p_in_ct, const SliceSettings& settings = {});

}  // namespace planlight
