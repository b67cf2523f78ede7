#pragma once

#include <array>
#include <optional>
#include <vector>

#include "projection/draw_plan.h"
#include "projection/find_light.h"
#include "projection/skin_surface.h"
#include "projection/stroke_places.h"

namespace planlight {

/// A small figure, a drill hole among others say, none of whose strokes the cameras can tell apart from other light
/// (`segments_of`): it is looked for whole, with what is drawn about it, as a pattern on a patch of skin.
struct FigurePatch {
    int item = -1;
    /// At the figure's middle, square to each other: along which its light is told. One place each.
    std::array<StrokeSegment, 2> sides;
    std::vector<StrokeSegment> outline;  ///< pieces of its strokes; sideways is away from its middle
    bool small_ring = false;             ///< the outline's other side is too near to be skin beside it
    StrokeSegment extent;                ///< places at its ends and its middle: who sees them sees it
    double half_mm = 0;                  ///< half the side of the pattern
    int size = 0;                        ///< cells of the pattern along a side, `kPatchStep_mm` apart
    std::vector<float> light;            ///< size x size: 1 where a stroke is lit, blurred
    std::vector<float> weight;           ///< 0 where other light is wanted whose brightness is not known
    /// The skin under the patch and its surroundings, (row, column) of -1, 0, 1 half sides of what is searched.
    std::array<Eigen::Vector3d, 9> skin_in_ct;
};

constexpr double kPatchStep_mm = 0.25;

/// Of all items that have no segment, or of `bright_item` where it has none. Left out: figures of more than 16 mm,
/// those that reach over the skin's edge, and those half of which lies under a label.
std::vector<FigurePatch> patches_of(const PlanDrawing& drawing, const SkinSurface& skin,
                                    const std::vector<StrokeSegment>& segments, const CheckLightSettings& settings,
                                    std::optional<std::size_t> bright_item = {});

/// The figure's light as one camera sees it, along both sides: the shift at which the pattern correlates best with the
/// picture (normalised, weighted), to `search_mm`; its noise by what the pattern leaves unexplained (Cramer-Rao). No
/// light where the correlation is weak, or as good a millimetre elsewhere.
std::array<CameraLook, 2> find_figure(const FigurePatch& patch, const CameraModel& camera,
                                      const RigidTransform& rig_from_ct, const GrayImage& picture,
                                      const CheckLightSettings& settings);

}  // namespace planlight
