#pragma once

#include <optional>

#include "planning_io/types/volume.h"

namespace planlight {

/// The volume's least value, where a hundredth and more of it are places that show nothing but that value, as do all
/// six voxels round them: blanked corners, padding, a face that was taken away - or air without noise. Else empty.
std::optional<float> blank_value(const Volume& volume);

/// Makes those places not a number.
void forget_blank(Volume& volume, float blank);

}  // namespace planlight
