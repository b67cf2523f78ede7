#pragma once

#include <optional>

#include "planning_io/types/image.h"
#include "projection/stroke_places.h"

namespace planlight {

/// Light across a stretch of stroke, as one camera sees it.
struct FoundLight {
    double off_mm = 0, sigma_mm = 0;  ///< along the places' `sideways_in_ct`
    double peak_grey = 0;
    /// Than the skin beside it, as a share of that: of a stroke of its width, whatever the camera's blur makes of it.
    double brighter = 0;
};

/// Whether a camera can be asked about a segment, and what it saw.
struct CameraLook {
    bool asked = false;     ///< the stretch is in the picture, near enough and not too oblique
    double background = 0;  ///< grey beside the stroke
    std::optional<FoundLight> light;
};

/// The ridge of light nearest in shape to a stroke's, in the mean profile across the places of the segment: matched
/// filter with the width of the stroke and of a pixel, its top by a parabola, noise by the median of what the filter
/// gives beside it. Whether the camera sees the segment freely is for the caller to know.
CameraLook find_light(const StrokeSegment& segment, const CameraModel& camera, const RigidTransform& rig_from_ct,
                      const GrayImage& picture, const CheckLightSettings& settings);

}  // namespace planlight
