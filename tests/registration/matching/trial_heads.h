#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "planning_io/types/skin_lut.h"
#include "tests/registration/matching/trial_surface.h"

namespace planlight::test {

/// A head of the trials: what its CT or MR led to (the product's table, by segmentation), and the surface that is
/// scanned.
struct TrialHead {
    std::string name;
    SkinLut lut;           ///< made with the product's own settings: decimated mesh, 1 mm voxels, 2 mm distance field
    TrialSurface surface;  ///< the truth: as fine as the voxels, or the analytic surface itself
};

/// Where the heads are that do not come with a package. Those not given or not there are left out.
struct TrialHeadFiles {
    std::filesystem::path ch2;                   ///< ch2.nii.gz of Debian's mricron-data: an MR head
    std::filesystem::path mannequin;             ///< dummyhead.mesh.ply of R's Rvcg, mm; x left, y up, z to the front
    std::filesystem::path ct_head;               ///< the DICOM folder of 3D Slicer's CTHeadAxialDicom
    std::vector<std::filesystem::path> volumes;  ///< any others, named by their files
};

/// The example patient (if installed), those of the files, and four analytic heads: the one of tests/support, a long
/// one and a round one that differ in every measure, and the long one with a CT that ends above the mouth (its scans go
/// on below). About 3 s each.
std::vector<TrialHead> trial_heads(const TrialHeadFiles& files);

/// A part of an analytic head: an ellipsoid.
struct Ellipsoid {
    Eigen::Vector3d centre, half_axes;
};

/// A closed mesh of ellipsoids blended over `blend_mm`; vertices on the blended surface to 0.01 mm.
TriangleMesh blended_mesh(const std::vector<Ellipsoid>& parts, double blend_mm, double edge_mm);

}  // namespace planlight::test
