#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "projection/draw_plan.h"
#include "projection/skin_paths.h"

namespace planlight {

/// An item whose points lie more than this many times `max_distance_to_skin_mm` from the skin is not drawn at all: the
/// place on the skin nearest to it would be a guess (most often the plan is in another frame).
inline constexpr double kTooFarFactor = 3;

inline bool finite(const Trajectory& t) {
    return t.entry_in_ct.allFinite() && t.target_in_ct.allFinite() && std::isfinite(t.diameter_mm);
}
inline bool finite(const Borehole& b) {
    return b.position_in_ct.allFinite() && (!b.axis_in_ct || b.axis_in_ct->allFinite()) &&
           std::isfinite(b.diameter_mm) && std::isfinite(b.depth_mm);
}
inline bool finite(const OsteotomyLine& o) {
    for (const auto& p : o.points_in_ct)
        if (!p.allFinite()) return false;
    return true;
}
inline bool finite(const CutPlane& c) {
    return c.origin_in_ct.allFinite() && c.normal_in_ct.allFinite() && c.first_axis_in_ct.allFinite() &&
           std::isfinite(c.width_mm) && std::isfinite(c.height_mm);
}

/// True when the point lies under the skin, or when three of four straight ways from it end at the surface: in the
/// cranium under a surface of bone, which has no inside of its own and holes.
bool in_the_body(const SkinSurface& skin, const Eigen::Vector3d& p_in_ct);

/// What is wrong with one item, one sentence each, by name.
std::vector<std::string> faults(const Trajectory& t, const SkinSurface& skin, const DrawingSettings& s);
std::vector<std::string> faults(const Borehole& b, const SkinSurface& skin, const DrawingSettings& s);
std::vector<std::string> faults(const OsteotomyLine& o, const SkinSurface& skin, const DrawingSettings& s);
std::vector<std::string> faults(const CutPlane& c, const SkinSurface& skin, const DrawingSettings& s);

}  // namespace planlight
