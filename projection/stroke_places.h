#pragma once

#include <vector>

#include "projection/check_light.h"

namespace planlight {

/// A place on a stroke at which light is looked for.
struct StrokePlace {
    Eigen::Vector3d p_in_ct, normal_in_ct, along_in_ct, sideways_in_ct;  ///< directions: unit, square to each other
    double width_mm = 0;                                                 ///< of the stroke
    bool lit = true;  ///< false in the gaps of a dashed stroke and beside their ends
};

/// Some millimetres of one stroke.
struct StrokeSegment {
    int item = -1;
    bool tick = false;  ///< the arms of a tick that crosses its line
    std::vector<StrokePlace> places;
    double search_mm = 0;  ///< to both sides: no other light is wanted there
    const StrokePlace& middle() const { return places[places.size() / 2]; }
};

/// The drawing's strokes, labels aside, cut into segments of about `segment_mm` (of circles and of strokes under three
/// of them half of it). Left out: what lies so near another stroke or label that its light could be mistaken. Of a tick
/// only what lies beside its line, and only where that line goes on to both sides: its light is then the same all along
/// the profile.
std::vector<StrokeSegment> segments_of(const PlanDrawing& drawing, const CheckLightSettings& settings);

/// What `segments_of` leaves out because other items are lit too near, in segments of the same length: of items that
/// have segments; the others are told whole (`patches_of`), and small figures of which a part is seen.
std::vector<StrokeSegment> crowded_segments_of(const PlanDrawing& drawing, const std::vector<StrokeSegment>& segments,
                                               const CheckLightSettings& settings);

/// The places of a stroke, evenly along it.
std::vector<StrokePlace> places_along(const Stroke& stroke, double spacing_mm);

/// A place on each item of the drawing, on the middle of its longest stroke that is no label and no mark; empty for
/// items without.
std::vector<std::optional<StrokePlace>> places_of_items(const PlanDrawing& drawing);

/// Of each item, the diagonal of the box round its strokes, labels left out, mm; 0 for items without.
std::vector<double> extents_of_items_mm(const PlanDrawing& drawing);

/// True when a device sees the place: in its picture, not too steep, no skin before it.
bool freely_seen(const StrokePlace& place, const SkinSurface& skin, const CameraModel& device,
                 const RigidTransform& rig_from_ct, double steepest);

}  // namespace planlight
