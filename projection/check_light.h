#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "planning_io/types/rig_calibration.h"
#include "planning_io/types/stereo_frame.h"
#include "projection/draw_plan.h"
#include "projection/skin_surface.h"

namespace planlight {

struct CheckLightSettings {
    double spacing_mm = 0.5;  ///< between the places that are looked at along a stroke
    double segment_mm =
        5;  ///< of stroke whose profiles are averaged before light is looked for; of circles and short strokes: half
    double search_mm = 3;             ///< to both sides of where the light belongs, less where another stroke is near
    double least_search_mm = 1.2;     ///< where less is free of other strokes nothing is looked for
    double least_peak_sigmas = 6;     ///< light stands out from the profile's noise by this
    double least_peak_grey = 1.5;     ///< and by this
    double least_px_per_mm = 0.5;     ///< a camera that sees the skin more obliquely or from farther is not asked
    double steepest = 1.2;            ///< radians between the skin's normal and projector or camera
    double steepest_lit = 1.31;       ///< up to which the projector lights it (`RenderSettings::steepest`)
    double place_sigma_mm = 0.1;      ///< of one segment beside its noise: texture, the skin's own shape
    double least_depth_mm = 0.3;      ///< of light above or below the drawing's skin, or three sigmas of it
    std::size_t most_segments = 120;  ///< looked at in one frame; of more they take turns
    bool far_too = true;              ///< light that is not where it belongs is looked for farther off (`far_mm`)
    int look_again_every = 8;         ///< frames: who sees which segment is asked anew in so many parts
};

/// Where the light of one stretch of stroke was seen.
struct SeenSegment {
    int item = -1;
    Eigen::Vector3d p_in_ct, sideways_in_ct;  ///< its middle; unit vector along the skin, square to the stroke
    Eigen::Vector3d normal_in_ct;             ///< of the skin
    bool tick = false;       ///< an arm of a tick, which tells of the way along its line; counted only where it is seen
    bool seen = false;       ///< light was found; false: none within reach, though it should be seen
    double off_mm = 0;       ///< of the light along `sideways_in_ct`, on the skin as high as it is there
    double by_depth_mm = 0;  ///< the part of it that is seen by its height alone, its own or `ItemLight::depth_mm`
    double sigma_mm = 0;     ///< one standard deviation of that
    double background = 0;   ///< grey of the skin beside the stroke, mean of the cameras that looked
    double brighter = 0;     ///< the light than that skin, as a share of it; by the camera that sees more of it
    std::array<std::optional<double>, 2> by_camera_mm;  ///< as the left and the right camera see it
};

/// Where one item's light lies against the plan.
struct ItemLight {
    std::string name;
    bool lit = false;  ///< the projector's light reaches it; a camera may not see it, or not apart from other light
    bool dim =
        false;  ///< it is lit dimly beside a bright one (`LightChecker`): that nothing is seen of it tells nothing
    /// Diagonal of the box round its strokes; infinite: not known.
    double extent_mm = std::numeric_limits<double>::infinity();
    int lit_segments = 0;        ///< stretches of it that the projector lights
    int steep_segments = 0;      ///< of these, lit at more than `CheckLightSettings::steepest`: nobody asks for them
    int segments = 0, seen = 0;  ///< of these, what should be seen by a camera, and where light was found
    Eigen::Vector3d shift_in_ct = Eigen::Vector3d::Zero();  ///< of the light along the skin, mm
    double off_mm = 0;                                      ///< its length, in the directions that the strokes tell
    double sigma_mm = 0;                                    ///< one standard deviation of it
    /// The farthest that two stretches side by side lie beside their place, both at least and to the same side, or one
    /// beside another that is not found: a part of the item may lie elsewhere than the whole of it, where the skin has
    /// risen under that part.
    double part_off_mm = 0;
    bool one_direction_only = false;  ///< a straight line tells nothing along itself
    /// Of the light above the drawing's skin as both cameras see it, mm: the skin there has risen since the scan, or
    /// sunk. Empty where they do not tell it, or not clearly from nothing.
    std::optional<double> depth_mm;
    /// So far aside it may lie, mm, by a height of the skin that the cameras do not tell, one of them alone seeing it
    /// say (`aside_by_untold_height_mm`); 0 where they tell it.
    double by_untold_height_mm = 0;
    bool known() const { return seen > 0; }
    /// Enough of it was seen to stand for all of it: one stretch of four that lies right says nothing of the others.
    bool told() const { return seen > 0 && 2 * seen >= segments; }
};

/// What the cameras see of the light. All lengths are along the skin, mm.
struct LightCheck {
    std::vector<ItemLight> items;  ///< as in the drawing
    std::vector<SeenSegment> segments;
    int lit = 0, expected = 0, seen = 0;  ///< segments: lit by the projector, of these to be seen by a camera, seen
    int lit_seen = 0;                     ///< of `lit`, in which no tick counts
    double off_mm = 0;                    ///< 95 % of the segments' sides lie within this; 0 when nothing was seen
    double median_mm = 0;
    double most_mm = 0;  ///< a third of the sides lie beyond this: light as a whole, not what falls on a hand before it
    double sigma_mm = 0;    ///< of a single segment, median
    double background = 0;  ///< grey of the skin beside the strokes, median; 0 when no camera looked
    /// The brightest tenth of the segments than the skin beside them, as a share of that: 1 is twice as bright as the
    /// skin, 0 that nothing was seen. Dim items do not count against it.
    double brighter = 0;
    double fainter = 0;  ///< the same of the faintest fifth: a lamp's spot may lie on a part of the plan
    /// True where the segments that were seen tell the light's place in two directions along the skin. Straight lines
    /// side by side do not: along itself such light could lie anywhere.
    bool told_whole = false;
    /// All light as one was found so far beside its place, mm, beyond 2 mm (`find_far_light`). Looked for where under
    /// 80 % of the stretches are seen near their place or 95 % of the light lie beyond 1 mm there; every second time
    /// only, as long as nothing is found. Strokes that are seen near their place then are others, or no light.
    std::optional<double> far_mm;
    /// How far the light lies beside the plan, as far as it is known.
    double light_off_mm() const { return far_mm ? std::max(*far_mm, off_mm) : off_mm; }
    double seen_share() const { return expected == 0 ? 0 : static_cast<double>(seen) / expected; }
};

struct RenderCounts;

/// What the projector lit of each item in the picture that was looked at: of a figure at the light's edge a part is lit
/// though the places that CHECK asks lie in the dark.
void note_lit_items(const RenderCounts& shown, LightCheck& check);

/// CHECK: the light of a drawing as both cameras see it, against where it belongs.
///
/// Each stroke (labels are not asked) is predicted into the cameras; across it, in the tangent plane of the skin, the
/// brightest ridge of the width of a stroke is looked for in the mean of some millimetres of stroke. Where the two
/// cameras see an item's light apart, or that of a part of it, it lies on skin that is higher or lower than the
/// drawing's, and so farther aside than either sees it. Stretches near another stroke are left out: their light could
/// be that one's; they count as lit, though. Along a line the arms of its ticks tell. What all parties share cannot be
/// seen: skin that slid over the bone, markers that moved on the head all together, an error common to CT and scan.
///
/// With `bright_item`, an index into `PlanDrawing::items`, that one alone is lit in full and asked; the light of all
/// others is dim: what is seen of it stands in their own `ItemLight` and nowhere else.
///
/// Keeps references to skin and rig; which segment is seen by whom is kept from frame to frame.
class LightChecker {
public:
    LightChecker(const PlanDrawing& drawing, const SkinSurface& skin, const RigCalibration& rig,
                 const CheckLightSettings& settings = {}, std::optional<std::size_t> bright_item = {});
    ~LightChecker();
    LightChecker(LightChecker&&) noexcept;

    /// One frame. `rig_from_ct` is where the head was at its exposure, so that a picture that was late, or drawn for
    /// another pose, is seen as light beside the plan.
    LightCheck look(const RigidTransform& rig_from_ct, const StereoFrame& frame);

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

/// One frame by a checker of its own.
LightCheck check_light(const PlanDrawing& drawing, const SkinSurface& skin, const RigCalibration& rig,
                       const RigidTransform& rig_from_ct, const StereoFrame& frame,
                       const CheckLightSettings& settings = {});

}  // namespace planlight
