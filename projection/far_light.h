#pragma once

#include <array>
#include <optional>
#include <vector>

#include "planning_io/types/rig_calibration.h"
#include "planning_io/types/stereo_frame.h"
#include "projection/skin_surface.h"
#include "projection/stroke_places.h"

namespace planlight {

/// A stretch that the projector lights, and which cameras see it freely.
struct SightedSegment {
    const StrokeSegment* segment = nullptr;
    std::array<bool, 2> seen{};  ///< by the left and the right camera
    bool one_side = false;       ///< skin is beside it where `sideways_in_ct` points only
};

struct FarLightSettings {
    double reach_mm = 12;            ///< on the skin, to all sides of where the light belongs
    double step_mm = 0.75;           ///< between the shifts that are tried: within a stroke's width
    std::size_t most_segments = 60;  ///< more are thinned evenly
    std::size_t least_segments = 5;  ///< of each camera; of fewer nothing is said
    double least_sigmas = 2.5;       ///< a stretch's light stands out by this from what lies around its place
    double least_grey = 1.5;         ///< and by this
    double least_share = 0.25;       ///< of the stretches, in each camera's picture, at one and the same shift
    double least_share_more = 0.2;   ///< than at most other shifts: skin has lines of its own
    double least_score = 1.4;        ///< sigmas, mean of the stretches, by the camera that sees less
    double least_score_more = 1.25;  ///< times that of any other shift
    double near_mm = 2;              ///< light so near its place is not far; shifts so near each other are the same
};

/// How far aside all the light lies as one, where it is farther than `find_light` looks, mm on the skin (median of the
/// stretches); of straight lines side by side, the least that explains them. Empty when no shift of the projector's
/// picture within reach puts the light of the drawing on what both cameras see, or one of less than `near_mm` does.
///
/// The picture as a whole is shifted, its light followed to the skin by rays, and each stretch looked for across its
/// own direction. Both cameras must see it at the same shift: light that a hand holds up before the skin lies elsewhere
/// for each of them.
std::optional<double> find_far_light(const std::vector<SightedSegment>& segments, const SkinSurface& skin,
                                     const RigCalibration& rig, const RigidTransform& rig_from_ct,
                                     const StereoFrame& frame, const FarLightSettings& settings = {});

}  // namespace planlight
