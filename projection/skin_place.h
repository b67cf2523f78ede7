#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "planning_io/types/plan.h"
#include "planning_io/types/triangle_mesh.h"
#include "projection/skin_paths.h"
#include "projection/skin_surface.h"

namespace planlight {

/// So far along its axis an item's place on the skin is looked for.
inline constexpr double kMostAlong_mm = 60;
/// A place farther than this beside its axis, or beside the border of the surface, is a wrong one: it is not drawn.
inline constexpr double kMostAside_mm = 2;
/// From here on it is told of.
inline constexpr double kToldAside_mm = 0.1;

/// Where an item has its place on the skin.
struct PlaceOnSkin {
    SkinSurface::Point at;
    double along_mm = 0;  ///< from the item's own point along its axis; 0 where that does not meet the skin
    double aside_mm = 0;  ///< of the place to the axis; without an axis how far the item lies beyond the border
};

/// Where the axis of an item through `p_in_ct`, unit and inwards, passes through the skin: outwards the first way out
/// of the body when the point lies under the skin, inwards the first way in when it lies over it, within
/// `kMostAlong_mm`. The nearest point where there is no such place: `aside_mm` of the axis.
PlaceOnSkin place_on_axis(const SkinSurface& skin, const Eigen::Vector3d& p_in_ct, const Eigen::Vector3d& inwards);

/// The nearest point; `aside_mm` where the surface ends before it lies under or over `p_in_ct`.
PlaceOnSkin place_nearest(const SkinSurface& skin, const Eigen::Vector3d& p_in_ct);

/// On the skin as it is now: along the axis there; of a hole without one its place on the CT's skin, carried along.
PlaceOnSkin place_of(const Trajectory& t, const SkinSurface& ct_skin, const SkinSurface& skin_now);
PlaceOnSkin place_of(const Borehole& hole, const SkinSurface& ct_skin, const SkinSurface& skin_now);

/// It leans on an axis of its own, and is not carried with the skin.
bool has_axis(const Borehole& hole);

/// The way a hole is drilled, unit and inwards: its axis, else the skin's perpendicular over 8 mm round it.
Eigen::Vector3d drilling_direction(const Borehole& hole, const SkinSurface& skin);

/// What the skin is not in a triangle: any corner at the end of the volume, else any on a lid.
SkinFlag flag_at(const SkinSurface& skin, int triangle);
inline SkinFlag flag_at(const SkinSurface& skin, const SkinSurface::Point& at) {
    return flag_at(skin, at.triangle);
}

/// Why nothing can be drawn at a place on this skin, in words that follow the item's name; `what` is the item's own
/// point ("its entry"). Empty where something can.
std::optional<std::string> no_place(const SkinSurface& skin, const PlaceOnSkin& place, const char* what, bool axis);

/// What is to be said of a line as it lies on the skin.
struct LineOnSkin {
    double at_end = 0, on_lids = 0;  ///< shares of its points
    double widest_step_mm = 0;       ///< between two neighbours
    double narrowest = 1;            ///< of a ring: straight across, its least share of twice the radius
};
LineOnSkin look_at(const SkinSurface& skin, const SkinLine& line);
/// Of `circle`; `beyond`: the share of it that the surface has no room for.
struct RingOnSkin : LineOnSkin {
    double beyond = 0;
};
RingOnSkin ring_on_skin(const SkinSurface& skin, const SkinSurface::Point& centre, double radius_mm,
                        double max_segment_mm);

}  // namespace planlight
