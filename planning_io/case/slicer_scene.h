#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "planning_io/types/image.h"
#include "planning_io/types/plan.h"
#include "planning_io/types/point_cloud.h"
#include "planning_io/types/rigid_transform.h"
#include "planning_io/types/triangle_mesh.h"

namespace planlight {

/// A line of light on the skin.
struct SlicerLine {
    std::vector<Eigen::Vector3d> points_in_ct;
    bool closed = false;
    Rgb colour{255, 255, 255};
};

/// What 3D Slicer is shown of a match. Every part may be empty.
struct SlicerScene {
    TriangleMesh skin;
    Plan plan;
    PointCloud cloud;
    RigidTransform ct_from_rig = RigidTransform::Identity();  ///< at the scan; for the cloud
    bool confirmed = true;                                    ///< the match; if not, the transform's name says so
    std::vector<SlicerLine> light;
};

/// Writes a new folder, its owner's alone, that 3D Slicer opens when its scene.mrml is dragged in: skin.vtp and
/// light.vtp in ct, cloud.vtp in rig under the transform ct_from_rig.tfm, and each item of the plan as plan-N.mrk.json.
/// All in mm; every file says that it is in LPS, which Slicer turns into its own RAS; the matrix in scene.mrml itself
/// is of RAS, as Slicer has it there. Throws InputError when the folder is there and not empty, DiskError.
void write_slicer_scene(const SlicerScene& scene, const std::filesystem::path& folder);

}  // namespace planlight
