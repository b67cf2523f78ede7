#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "planning_io/types/plan.h"
#include "planning_io/types/volume.h"
#include "projection/skin_surface.h"

namespace planlight {

/// From when on a plan is doubted; lengths in mm.
struct PlanCheckSettings {
    double near_skin_mm = 10;      ///< an entry, borehole or line farther from the skin is warned of
    double too_far_mm = 30;        ///< and is not drawn from here on: the plan is stopped
    double max_depth_mm = 200;     ///< of a trajectory or a borehole
    double outside_volume_mm = 2;  ///< beyond the outermost voxel centres
    double side_margin_mm = 5;     ///< nearer to the mid-plane than this, an item may be called left or right
    double max_share_far =
        0.5;  ///< of the items farther than `near_skin_mm` from the skin; from here on the plan is stopped
    double above_skin_mm = 2;        ///< less is not above; a risk structure that is so wholly is stopped
    double in_air_mm = 5;            ///< lines and boreholes that nearly all lie this far outside are stopped
    double structure_outside = 0.1;  ///< a larger share of one outside of the body is warned of
    double structure_cut = 0.05;     ///< a larger share outside of the volume is stopped, a smaller one warned of
    double turned_fit_mm =
        1;  ///< a turned or mirrored copy of the plan with 90 % of its points this near to the skin ...
    double turned_gain = 3;  ///< ... and this many times nearer than half of the plan's own: stopped
    bool on_skin = true;     ///< false: on a surface that somebody else segmented, bone for example
};

/// On a surface that somebody else segmented, bone for example, much of a plan may lie above it. `given`: false: on
/// skin.
inline PlanCheckSettings plan_checks_on(bool given) {
    PlanCheckSettings settings;
    settings.on_skin = !given;
    if (given) settings.above_skin_mm = settings.too_far_mm;
    return settings;
}

/// The box of a volume's voxel centres: what lies outside was never scanned.
struct VolumeBox {
    Eigen::Affine3d ct_from_voxel = Eigen::Affine3d::Identity();
    std::array<int, 3> size{0, 0, 0};
};
inline VolumeBox box_of(const Volume& volume) {
    return {volume.ct_from_voxel, volume.size};
}

/// What a plan looks like on the skin that it is to be shown on.
struct PlanVerdict {
    std::vector<std::string>
        stops;  ///< the plan must not be shown: one sentence each, with the item's name and the numbers
    std::vector<std::string> warnings;  ///< one sentence each, with the item's name
    bool outside_volume = false;        ///< a stop is that something lies outside the volume, wherever the skin is
    double median_to_skin_mm = 0;       ///< of entries, boreholes and lines' points
    double share_far = 0;               ///< of the items, farther than `near_skin_mm`
};

/// Judges a plan by its patient's skin: entries near the skin, on their axes and not on the end of the volume, targets
/// and risk structures inside, nothing swapped, zero, NaN or outside the volume, sides as their names say, and no
/// turned or mirrored copy of the plan that fits the skin far better than the plan does, and not all of it in the air.
PlanVerdict check_plan(const Plan& plan, const SkinSurface& skin, const std::optional<VolumeBox>& volume = std::nullopt,
                       const PlanCheckSettings& settings = {});

/// Throws InputError with the first stops when there are any.
void refuse_stopped_plan(const PlanVerdict& verdict);

}  // namespace planlight
