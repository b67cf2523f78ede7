#pragma once

#include <string>

#include "tests/registration/matching/trial_surface.h"

namespace planlight::test {

/// Things that are no head, as closed surfaces in a frame of their own, centred on the origin, edges of about 2 mm.
TrialSurface sphere_object(double radius_mm);
/// Upright (z), rounded ends.
TrialSurface cylinder_object(double radius_mm, double height_mm);
/// An egg: half axes differ, nothing on it.
TrialSurface egg_object(const Eigen::Vector3d& half_axes_mm);
/// A sphere whose radius waves by up to a quarter, smoothly, drawn by the seed: as much shape as a head, but another.
TrialSurface lump_object(double radius_mm, unsigned seed);

}  // namespace planlight::test
