#pragma once

#include <Eigen/Geometry>
#include <random>
#include <vector>

#include "planning_io/types/rigid_transform.h"
#include "registration/simulation/true_surface.h"

namespace planlight::simulation {

/// Where the light is to fall: the middle of the plan's points on the skin, or the face when there are none.
struct WorkRegion {
    Eigen::Vector3d centre_in_ct, outwards_in_ct;
};

/// Points off the skin count by the skin nearest to them.
WorkRegion find_work_region(const TrueSurface& skin, const std::vector<Eigen::Vector3d>& plan_points_in_ct);

/// Lays the head under the projector: the region faces it within 30 degrees, at any angle about the line of sight.
RigidTransform lay_head(const TrueSurface& skin, const WorkRegion& region, std::mt19937& random);

}  // namespace planlight::simulation
