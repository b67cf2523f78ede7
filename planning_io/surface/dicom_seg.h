#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "planning_io/plan/plan_import.h"
#include "planning_io/types/triangle_mesh.h"

namespace planlight {

/// True for a file with "DICM" at byte 128.
bool is_dicom_file(const std::filesystem::path& file);

/// The surface of one segment of a DICOM Segmentation (binary, uncompressed), parsed in a child process: the half-way
/// surface of its voxels, smoothed over one voxel. `segment` is its label, and needed when there are several. Frames
/// that are left out are empty. Its frame of reference must be the CT's. Throws InputError for anything else, by name.
TriangleMesh read_dicom_seg(const std::filesystem::path& file, const std::string& segment,
                            const PlanImportSettings& settings, std::vector<std::string>& notes);

}  // namespace planlight
