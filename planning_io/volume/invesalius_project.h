#pragma once

#include <filesystem>
#include <vector>

#include "planning_io/types/triangle_mesh.h"
#include "planning_io/types/volume.h"

namespace planlight {

/// The volume of an InVesalius project (.inv3: gzip tar of plists and a raw int16 matrix), HU, ct frame LPS.
///
/// Mind the mirror: matrix rows run towards anterior, and the project's own surfaces are at (x, -y, z) of matrix
/// coordinates. The project does not store the scanner's origin: voxel (0,0,0) of the matrix gets x = 0, z = 0 and y so
/// that the surfaces of the project coincide with the volume. InputError when it was not made from axial DICOM slices:
/// the axes of other imports are others, and not said.
Volume read_invesalius_volume(const std::filesystem::path& file);

/// The surfaces stored in the project, in the same ct frame as `read_invesalius_volume` gives. Empty when there are
/// none.
std::vector<TriangleMesh> read_invesalius_surfaces(const std::filesystem::path& file);

}  // namespace planlight
