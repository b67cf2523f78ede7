#pragma once

#include <filesystem>
#include <vector>

#include "planning_io/types/volume.h"

namespace planlight {

/// Fewest voxels along each axis of a volume that a skin is taken from.
inline constexpr int kFewestSlices = 16;

/// Throws InputError unless the axes are finite, perpendicular and of one length each to `tolerance`, spaced 0.01 to 20
/// mm, with at least 16 voxels and 10 to 3000 mm along each, within 10 m of the origin. `file` is named in the refusal.
void check_grid(const Volume& volume, const std::filesystem::path& file, double tolerance);

/// Reverses the slices of a left-handed grid; every voxel keeps its place in ct.
void make_right_handed(Volume& volume);

/// Whether air is as dark as in HU: one voxel of a thousand at -705 or below. `left_out`: marks voxels (1) that are not
/// asked; may be empty.
bool has_air_in_hu(const Volume& volume, const std::vector<char>& left_out = {});

/// For files that do not say it: a volume whose air is that of HU, and that holds a body in HU, is a CT in HU; one of a
/// CT to whose values 1024 was added is made one; another one is an MR. Noted in `volume.notes`.
void tell_modality_by_values(Volume& volume);

/// Throws InputError when there can be no skin in the volume: one value only, nothing but air, no air, or a body that
/// fills the volume to all of its sides (a cut-out of the head's inside).
void check_for_skin(const Volume& volume, const std::filesystem::path& file);

}  // namespace planlight
