#pragma once

#include <optional>
#include <string>

#include "planning_io/types/skin_displacement.h"
#include "projection/draw_plan.h"

namespace planlight {

/// The CT's skin moved along its normals to where the scan found it. Triangles, and so the places on them, are the
/// same. Where nothing is known it is the CT's skin.
SkinSurface skin_as_scanned(const TriangleMesh& ct_skin, const SkinDisplacementField& field);

/// Over how much of an item (index into `planned.items`) the scan saw something on the skin, in a sentence with its
/// name; empty under a tenth of it. `planned`: as drawn on the CT's skin.
std::optional<std::string> covered_in_words(const PlanDrawing& planned, std::size_t item, const SkinDisplacement& skin);

/// Warns of every item of which a tenth or more lies where the scan saw no skin, or something else on it: there the
/// light may be aside.
/// `planned`: the same plan as drawn on the CT's skin.
void warn_of_unscanned(const SkinDisplacementField& field, const PlanDrawing& planned, PlanDrawing& drawing);

}  // namespace planlight
