#pragma once

#include <vector>

#include "projection/light_cause.h"

namespace planlight {

/// One seen segment of one frame, with what each fault would do to it. mm along its `sideways`.
struct LightSample {
    Instant at{};                     ///< of its frame
    double off_mm = 0;                ///< as seen, on the drawing's skin
    double weight = 1;                ///< 1 / variance
    double told_mm = 0;               ///< as the picture that should have been lit explains it: prediction and hold
    Eigen::Vector3d by_projector;     ///< per radian of the projector turned about its own axes
    std::vector<double> by_delay_mm;  ///< as the picture lit under each delay of the grid explains it
    std::optional<double> depth_mm;   ///< of the light under the skin as the two cameras see it apart
};

/// All samples of the frames since `from`.
std::vector<LightSample> light_samples(const std::vector<LightFacts>& facts, Instant from, const RigCalibration& rig,
                                       const std::vector<double>& delays_s);

/// Where light that was aimed at `p_in_ct` on a head at `drawn` falls on the same skin at `now`, along `sideways`, mm.
double aside_mm(const SeenSegment& segment, const RigidTransform& drawn, const RigidTransform& now,
                const CameraModel& projector);

}  // namespace planlight
