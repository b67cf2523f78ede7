#pragma once

#include <optional>
#include <vector>

#include "projection/check_light.h"

namespace planlight {

/// How far along `sideways_in_ct` a device at `centre_in_ct` goes per millimetre that its ray gains on the skin's
/// normal: what stands h above the skin is seen at -h times this.
double sideways_slope(const SeenSegment& segment, const Eigen::Vector3d& centre_in_ct);

/// Light that both cameras see at other places lies above or below the skin.
struct SeenDepth {
    double apart_mm = 0;  ///< left less right, along `sideways_in_ct`
    double slopes = 0;    ///< right less left
    double sigma_mm = 0;  ///< of `apart_mm`
};
struct LightDepth {
    double mm = 0, sigma_mm = 0;  ///< along the normal, positive outwards
};

/// The one depth that several stretches speak for: least squares with Huber weights, for a camera may take a gloss for
/// the light. Empty where they tell nothing of it; `told_well` asks whether they tell enough.
std::optional<LightDepth> fit_depth(const std::vector<SeenDepth>& seen);
bool told_well(const LightDepth& depth);

/// One camera's sight of a stretch, sideways.
struct SeenAside {
    double off_mm = 0;           ///< as that camera sees it, on the drawing's skin
    double projector_slope = 0;  ///< `sideways_slope`
    double camera_slope = 0;
};

/// How far aside the light of an item may lie by a height of the skin that nothing told, mm: skin that rose or sank by
/// h moves the light by h times the projector's slope, of which a camera sees h times the difference of the slopes
/// only. The height is bounded by what each camera sees aside and 0.4 mm, which other errors may hide, by
/// the depth and three sigmas of it where there is one, and by 3 mm.
double aside_by_untold_height_mm(const std::vector<SeenAside>& seen, const std::optional<LightDepth>& depth);

}  // namespace planlight
