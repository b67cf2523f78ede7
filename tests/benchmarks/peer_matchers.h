#pragma once

#include <functional>
#include <string>
#include <vector>

#include "planning_io/types/point_cloud.h"
#include "planning_io/types/rigid_transform.h"
#include "planning_io/types/triangle_mesh.h"

namespace planlight {

/// A matcher of another library on one skin: what it prepares of the skin once (trees, features) is behind the
/// function.
struct PeerMatcher {
    std::string name;
    /// Scan in rig, start `ct_from_rig` (which global matchers do not look at) -> ct_from_rig.
    std::function<RigidTransform(const PointCloud& scan, const RigidTransform& start)> match;
};

/// The skin as peers want it: points with outward normals, and the triangles for VTK.
struct PeerSkin {
    std::vector<Eigen::Vector3d> points_in_ct, normals_in_ct;
    const TriangleMesh* mesh = nullptr;
};

/// Settings as in their own tutorials, at the sizes that did best on heads. Global: no start is used.
std::vector<PeerMatcher> open3d_global(const PeerSkin& skin);
std::vector<PeerMatcher> open3d_icp(const PeerSkin& skin);
std::vector<PeerMatcher> pcl_global(const PeerSkin& skin);
std::vector<PeerMatcher> pcl_icp(const PeerSkin& skin);
std::vector<PeerMatcher> vtk_icp(const PeerSkin& skin);

}  // namespace planlight
