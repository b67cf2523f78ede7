#pragma once

#include <optional>

#include "planning_io/types/triangle_mesh.h"
#include "planning_io/types/volume.h"

namespace planlight {

/// The volume's least value, where a hundredth and more of it are places that show nothing but that value, as do all
/// six voxels round them: blanked corners, padding, a face that was taken away - or air without noise. Else empty.
std::optional<float> blank_value(const Volume& volume);

/// Makes those places not a number.
void forget_blank(Volume& volume, float blank);

/// Flags as kCutPlane what of the skin lies within two voxels of those places: there the head goes on unseen. Of a head
/// in air that was measured (`SkinMask::blank`); where the air itself is blank, `flag_blanked_edges` asks.
void flag_ends_at_blank(TriangleMesh& mesh, const Volume& volume, float blank);

}  // namespace planlight
