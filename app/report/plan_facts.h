#pragma once

#include <optional>
#include <string>
#include <vector>

#include "planning_io/types/plan.h"
#include "planning_io/types/skin_lut.h"
#include "projection/draw_plan.h"
#include "projection/mid_plane.h"

namespace planlight {

class SkinSurface;

/// How much a distance to the skin matters.
enum class Gravity { none, look, stop };

/// Of the page's style: "stop", "look", "".
const char* class_of(Gravity gravity);

/// What the one who signs must know of a plan item. Lengths in mm, angles in radians; empty where the item has none.
struct PlanFact {
    std::string kind;  ///< "closed line", "borehole" ...
    std::string name;
    std::string lit;                  ///< the code that the light has in place of the name, "#2"; else empty
    std::optional<double> length_mm;  ///< of a line along the skin
    std::optional<double> depth_mm;   ///< of a way or a hole
    std::optional<double> diameter_mm;
    std::optional<double> tilt;                    ///< between the way in and the skin's perpendicular
    std::optional<Eigen::Vector3d> inwards_in_ct;  ///< unit, of a way or a hole with an axis
    std::optional<double> over_bone_mm;            ///< soft tissue between skin and bone there
    std::optional<double> left_of_middle_mm;       ///< of its place on the skin, from the head's own mid-plane
    Clearances clearances;                         ///< to the plan's risk structures; what is worst first
    double to_skin_mm = 0;
    Gravity gravity = Gravity::none;
    std::string distance;  ///< in words that match its gravity
};

/// One for each item of the drawing, in its order (`draw_plan`). `mid_plane`: of the head, where it was found.
/// `surface`: the skin that the table was made from; tilts are against it.
std::vector<PlanFact> plan_facts(const Plan& plan, const PlanDrawing& drawing, const SkinLut& lut,
                                 const std::optional<MidPlane>& mid_plane = {}, const SkinSurface* surface = nullptr);

/// "38 mm right"; "in the middle" within 2 mm of it.
std::string side_in_words(double left_of_middle_mm);

/// What stands in the table of the distances to risk structures: the worst, and all that warn; "–" of none.
std::string risk_in_words(const Clearances& clearances);

/// The same for a page: a figure and its unit stay on one line; markup.
std::string risk_html(const Clearances& clearances);

/// How the worst of them is to be taken: "stop" through a structure, "look" under 2 mm.
Gravity gravity_of(const Clearances& clearances);

/// A distance to the skin in words, and how grave it is: "on the skin" up to 0.5 mm, "look" from 2 mm, "stop" where it
/// is not drawn (three times `max_distance_to_skin_mm`).
std::string distance_in_words(double mm, const DrawingSettings& settings = {});

/// How a distance of `mm` between plan and skin is to be taken, by the limits of the drawing.
Gravity gravity_of(double mm, const DrawingSettings& settings = {});

/// "12° to the left, 30° down" of a unit direction: out of the sagittal and out of the axial plane.
std::string direction_in_words(const Eigen::Vector3d& inwards_in_ct);

}  // namespace planlight
