#pragma once

#include <filesystem>
#include <string>

#include "planning_io/dicom/slice_gaps.h"
#include "planning_io/types/series_identity.h"
#include "planning_io/types/volume.h"

namespace planlight {

/// Reads a CT or MR volume: a folder (or any file) of a DICOM series, NIfTI-1 (.nii, .nii.gz), FreeSurfer (.mgh, .mgz),
/// NRRD (.nrrd, .nhdr), MetaImage
/// (.mha, .mhd) or an InVesalius project (.inv3). `series`: UID or number of the DICOM series, where the folder holds
/// several volumes. `gaps`: what to do with DICOM slices that are not evenly spaced. `identity`: told whose a DICOM
/// series is.
///
/// Everything is parsed in a child process with limits. Throws InputError for what is not one safe volume (missing or
/// double slice, uneven spacing, no frame ...; the list is in INTAKE.md), DamagedFileError for a damaged file.
Volume read_volume(const std::filesystem::path& path, const std::string& series = {},
                   SliceGaps gaps = SliceGaps::refused, SeriesIdentity* identity = nullptr);

/// Takes the file name or the series' UID and the frame of reference's UID away from a volume whose case must not name
/// a patient.
void make_anonymous(Volume& volume);

/// The hash of values and geometry (XXH3-128, hex): two volumes with the same hash are the same volume.
std::string hash_of(const Volume& volume);

}  // namespace planlight
