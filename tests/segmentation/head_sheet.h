#pragma once

#include <Eigen/Core>
#include <vector>

#include "planning_io/types/image.h"
#include "planning_io/types/triangle_mesh.h"
#include "planning_io/types/volume.h"

namespace planlight::test {

/// The skin from the front, both sides, behind and above (lids blue, ends of the volume red), and below the middle
/// slices of the volume with the skin's line: sagittal, sagittal through an eye, coronal, axial at two heights. Drawn
/// without OpenGL. `marks`, in ct, are drawn yellow where the views see them, and within 2 mm of a slice.
RgbImage head_sheet(const Volume& volume, const TriangleMesh& skin, const std::vector<Eigen::Vector3d>& marks = {});

}  // namespace planlight::test
