#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "planning_io/types/plan.h"

namespace planlight {

class SkinSurface;

/// How near an item of the plan comes to a risk structure, as planned.
struct Clearance {
    std::string structure;  ///< its name
    double mm = 0;          ///< from the item's solid to the structure's surface; 0 where it goes through
    bool through = false;   ///< it meets the surface, or lies within the structure

    bool operator==(const Clearance&) const = default;
};

/// Of one item, to every risk structure: what it goes through first, then the nearest. Empty where the plan holds none,
/// and of an item that is not finite.
using Clearances = std::vector<Clearance>;

/// Of all items, in the order of `PlanDrawing::items` (lines, holes, ways in, cut planes).
///
/// Smallest distance of solids, exact but for rounding (to 1e-6 mm): of a trajectory the straight way from entry to
/// target with half the instrument's diameter all round (its end is a half ball about the target); of a hole the
/// cylinder of its diameter and depth with a flat bottom, from its position along its axis (the skin's inward
/// perpendicular over 8 mm round where it has none, or nothing without a `skin`); of a line its points joined straight;
/// of a cut plane its rectangle. Structures are the triangles of their surfaces, and all within any of their pieces;
/// what lies in a cavity lies within.
std::vector<Clearances> clearances_of(const Plan& plan, const SkinSurface* skin);

/// So near is a warning, mm.
inline constexpr double kNearRisk_mm = 2;

/// In tenths of a millimetre, rounded down: it never says more room than there is.
double said_mm(const Clearance& clearance);
/// It goes through, or is said to be nearer than `kNearRisk_mm`.
bool warns(const Clearance& clearance);
/// How many of them warn.
std::size_t warnings_in(const Clearances& clearances);

/// "4.1 mm to Facial nerve", "through Facial nerve".
std::string clearance_in_words(const Clearance& clearance);

/// A sentence for each that warns: "Screw 1: it passes 1.2 mm from Facial nerve".
std::vector<std::string> risk_warnings(const std::string& item, const Clearances& clearances);

}  // namespace planlight
