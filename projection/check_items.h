#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "projection/draw_plan.h"
#include "projection/skin_paths.h"
#include "projection/skin_place.h"

namespace planlight {

/// An item whose points lie more than this many times `max_distance_to_skin_mm` from the skin is not drawn at all: the
/// place on the skin nearest to it would be a guess (most often the plan is in another frame).
inline constexpr double kTooFarFactor = 3;

/// Of a trajectory's ring, mm: half the instrument's diameter, or that of a symbol where it is not given or smaller.
inline double ring_radius_mm(const Trajectory& t) {
    constexpr double kSymbol_mm = 3;
    return std::max(t.diameter_mm / 2, kSymbol_mm);
}

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

/// Why an item has no place on this skin and is not drawn, by the words of `no_place`. Empty where it has one.
std::optional<std::string> no_place_of(const Trajectory& t, const SkinSurface& skin);
std::optional<std::string> no_place_of(const Borehole& b, const SkinSurface& skin);
std::optional<std::string> no_place_of(const OsteotomyLine& o, const SkinSurface& skin);

/// Unit axes, square to each other.
bool is_plane(const CutPlane& c);

/// What is wrong with one item, one sentence each, by name.
std::vector<std::string> faults(const Trajectory& t, const SkinSurface& skin, const DrawingSettings& s);
std::vector<std::string> faults(const Borehole& b, const SkinSurface& skin, const DrawingSettings& s);
std::vector<std::string> faults(const OsteotomyLine& o, const SkinSurface& skin, const DrawingSettings& s);
std::vector<std::string> faults(const CutPlane& c, const SkinSurface& skin, const DrawingSettings& s);

}  // namespace planlight
