#pragma once

#include <Eigen/Core>
#include <vector>

#include "projection/render_drawing.h"

namespace planlight {

/// A disc that no light may touch, in the projector's picture. It faces the projector, so that a sticker at any slant
/// is covered.
struct DarkDisc {
    Eigen::Vector2d centre;
    Eigen::Matrix2d disc_by_pixel;
    double reach = 0;
    bool covers(const Eigen::Vector2d& pixel) const { return (disc_by_pixel * (pixel - centre)).squaredNorm() < 1; }
};

/// Those of the settings' markers (`keep_dark_in_patient`, with the halo); markers that the projector does not face
/// have none.
std::vector<DarkDisc> dark_discs(const CameraModel& projector, const RigidTransform& rig_from_patient,
                                 const RenderSettings& settings);

/// Makes the picture black under them.
void darken(const std::vector<DarkDisc>& discs, RgbImage& picture);

}  // namespace planlight
