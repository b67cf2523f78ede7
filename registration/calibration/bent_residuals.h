#pragma once

#include <cstddef>

#include "planning_io/types/rig_calibration.h"
#include "registration/scan/triangulate/triangulate.h"

namespace planlight {

/// What the differences between a scan and the rig have in common from place to place. A wrong lens bends them: that
/// shows in the means of places (10 x 10 of a picture, with equally many points) when it is still far below the noise
/// of the points.
struct BentResiduals {
    /// By how much more the left camera's distortion k1 is off the rig's than the right one's, according to the
    /// distances from the epipolar lines, and one standard deviation by the scatter of the places. What a turned or
    /// shifted camera makes is taken out first; what bends both cameras' pictures alike cancels. Sigma 0: under 40
    /// places, not known.
    double k1_off = 0, k1_sigma = 0;
    /// rms over the places of decoded less expected projector pixel. 0: under 40 places.
    double projector_px = 0;
    std::size_t camera_places = 0, projector_places = 0;
};

/// `rig` with the projector placed by this scan (Resection), so that a moved one does not count as bent.
BentResiduals bent_residuals(const Triangulation& raw, const RigCalibration& rig);

}  // namespace planlight
