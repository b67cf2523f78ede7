#pragma once

#include <string>
#include <vector>

#include "planning_io/types/image.h"
#include "planning_io/types/plan.h"
#include "projection/skin_surface.h"

namespace planlight {

/// What a stroke belongs to.
enum class StrokeKind { osteotomy_line, borehole, trajectory, cut_plane, tick, label };

/// A line on the skin of constant width, measured along the skin.
struct Stroke {
    StrokeKind kind = StrokeKind::osteotomy_line;
    int item = -1;  ///< index into PlanDrawing::items
    Rgb colour{255, 255, 255};
    double width_mm = 0.8;
    bool closed = false;
    std::vector<Eigen::Vector3d> points_in_ct;   ///< on the skin, at most `max_segment_mm` apart
    std::vector<Eigen::Vector3d> normals_in_ct;  ///< outward, one per point
};

/// One plan item as drawn: where it was wanted and what is said about it.
struct DrawnItem {
    StrokeKind kind;
    std::string name;
    std::string label;                  ///< the text beside it, e.g. "B1  ⌀7  6 mm deep"
    Eigen::Vector3d anchor_in_ct;       ///< its place on the skin
    double distance_to_skin_mm = 0;     ///< of the plan's point(s) to the skin, largest
    std::vector<std::string> warnings;  ///< in words, with the item's name
    bool labelled = true;               ///< false where a crowded plan left no free skin for its label
};

/// The plan in the skin's own metric: what is light on the skin, independent of projector and pose.
struct PlanDrawing {
    std::vector<DrawnItem> items;
    std::vector<Stroke> strokes;
};

/// How a plan becomes lines on the skin; lengths in mm on the skin.
struct DrawingSettings {
    double line_width_mm = 0.8;
    double max_segment_mm = 0.5;
    double text_height_mm = 5;
    double tick_every_mm = 10, tick_length_mm = 2;  ///< along osteotomy lines; 0 = none
    Eigen::Vector3d up_in_ct{0, 0, 1};              ///< which way text stands up
    double max_distance_to_skin_mm = 10;            ///< a plan point farther from skin is warned of, by name
    bool labels = true;
    std::vector<Eigen::Vector3d>
        keep_clear_in_ct;  ///< marker centres: labels are not put within `keep_clear_radius_mm`
    double keep_clear_radius_mm = 11;
};

/// Draws every item of the plan on the skin: lengths along geodesics, circles of their diameter, labels upright.
///
/// Items come in the order osteotomy lines, boreholes, trajectories, cut planes. One that is not finite, or lies more
/// than three times `max_distance_to_skin_mm` from the skin, has no strokes, and a warning.
PlanDrawing draw_plan(const Plan& plan, const SkinSurface& skin, const DrawingSettings& settings = {});

/// The same on the skin as it is now (`skin_as_scanned` of `ct_skin`). What is fixed to the bone stays where it was
/// planned and is drawn where it meets the skin now: holes and trajectories along their axes, cut planes in their
/// planes. What is planned on the skin is carried with it: points of lines, holes without an axis. Distances and
/// warnings are those of the CT.
PlanDrawing draw_plan(const Plan& plan, const SkinSurface& ct_skin, const SkinSurface& skin_now,
                      const DrawingSettings& settings = {});

}  // namespace planlight
