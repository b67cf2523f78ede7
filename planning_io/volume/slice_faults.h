#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "planning_io/types/volume.h"

namespace planlight {

/// Notes in `volume.notes`, for any axis: slices that are there twice, bit for bit; neighbours that differ 2.5 times as
/// much as those around them, as where slices are missing: behind either the head is in the wrong place; and two slices
/// that fit 1.3 times better exchanged (up to 16 apart); and a slice of one value between others. Asked where
/// neighbours differ by noise nearly everywhere, as those of a scanner do. At the outer four slices, of exchanges at
/// the outer six, nothing is told. `stacked`: the axis from slice to slice where it is known (of DICOM 2); no other is
/// asked then.
void note_slice_faults(Volume& volume, std::optional<std::size_t> stacked = {});

/// Along each axis, how many times as much two neighbours differ as those around them, where they do the most; 0 along
/// an axis whose neighbours do not differ by noise, or where all around is plain. For tables of volumes.
std::array<double, 3> largest_slice_jumps(const Volume& volume);

/// Along each axis, how many times better the slices fit together with two of them exchanged, at best; 0 where it is
/// not asked. For tables of volumes.
std::array<double, 3> best_slice_exchanges(const Volume& volume);

}  // namespace planlight
