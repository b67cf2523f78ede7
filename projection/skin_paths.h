#pragma once

#include <Eigen/Core>
#include <vector>

#include "planning_io/types/plan.h"
#include "projection/skin_surface.h"

namespace planlight {

/// A line on the skin; of a closed one the last point is joined to the first and is not the same point.
struct SkinLine {
    std::vector<SkinSurface::Point> points;
    bool closed = false;
};

/// Along the skin, from its first point to its last; 0 under two points.
double length_mm(const SkinLine& line);

/// The straight way (geodesic) from one skin point to another, points at most `max_segment_mm` apart, both ends
/// included.
///
/// Found by shooting: walk, look where one arrives, correct the start direction. What is left of the gap on rough skin
/// is spread over the way (at most 2 % of it); where shooting does not arrive, the way is halved at the skin under its
/// middle.
SkinLine straight_way(const SkinSurface& skin, const SkinSurface::Point& from, const SkinSurface::Point& to,
                      double max_segment_mm);

/// Straight ways through all points in turn. Points nearer than 1e-6 mm to the one before are dropped.
SkinLine join(const SkinSurface& skin, const std::vector<SkinSurface::Point>& points, bool closed,
              double max_segment_mm);

/// All points at `radius_mm` from `centre` along the skin.
SkinLine circle(const SkinSurface& skin, const SkinSurface::Point& centre, double radius_mm, double max_segment_mm);

/// A straight line through `centre`, from `back_mm` behind to `ahead_mm` before it (negative: that far short of it).
SkinLine bar(const SkinSurface& skin, const SkinSurface::Point& centre, const Eigen::Vector3d& direction_in_ct,
             double back_mm, double ahead_mm, double max_segment_mm);

/// Where the plane's rectangle cuts the skin; the longest piece first, pieces under 1 mm dropped. The end of the volume
/// is no skin: pieces end there.
std::vector<SkinLine> trace(const SkinSurface& skin, const CutPlane& plane, double max_segment_mm);
/// How long the plane's cut of the end of the volume is, mm: what `trace` leaves out.
double trace_at_end_mm(const SkinSurface& skin, const CutPlane& plane);

/// A place on a line and which way it runs there.
struct LinePlace {
    SkinSurface::Point at;
    Eigen::Vector3d direction_in_ct;  ///< unit
};
/// At `way_mm` along the line from its first point.
LinePlace place_along(const SkinSurface& skin, const SkinLine& line, double way_mm);

}  // namespace planlight
