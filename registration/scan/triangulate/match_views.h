#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "planning_io/types/large_array.h"
#include "registration/scan/decode/decode_stripes.h"
#include "registration/scan/triangulate/triangulate.h"

namespace planlight {

/// A pixel of one camera, the projector pixel that lit it, and where the other camera sees that same light.
struct ViewMatch {
    Eigen::Vector2d pixel, code;  ///< of the camera; of the projector
    double sigma_px = 0;          ///< of the code, from the noise alone
    bool whole = false;           ///< no edge is near the pixel (see Correspondence)
    // Only for pixels that both cameras see:
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    Eigen::Matrix2d right_by_code = Eigen::Matrix2d::Zero();  ///< derivative of the right pixel by the code
    double right_sigma_px = 0;
};

/// What the codes alone say, before any geometry: it holds for every calibration of the rig.
struct ViewMatches {
    LargeArray<ViewMatch> both, left_only, right_only;  ///< in the order of the pixels of the left (right) picture
    std::size_t ragged = 0;                             ///< left pixels around which the code is not smooth
    Stride stride;
};

/// Finds the partners of the pixels of a grid of this stride. Both views must code columns and rows.
ViewMatches match_views(const DecodedView& left, const DecodedView& right, int projector_width, int projector_height,
                        Stride stride, bool one_camera);

}  // namespace planlight
