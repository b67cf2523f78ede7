#pragma once

#include <Eigen/Core>

#include "planning_io/types/point_cloud.h"
#include "planning_io/types/skin_lut.h"
#include "planning_io/types/triangle_mesh.h"

namespace planlight::test {

/// A head made of smooth blended spheres (skull, nose, chin, two unequal ears, brow, a dent in the forehead), in ct
/// (LPS), mm, about 160 x 200 x 230, centred near the origin. It has no symmetry, so that a mirrored or turned one is
/// wrong. Negative inside; the gradient has about unit length near the surface.
double analytic_head_distance(const Eigen::Vector3d& p_in_ct);
Eigen::Vector3d analytic_head_normal(const Eigen::Vector3d& p_in_ct);

/// The point of the surface that Newton's method reaches from `p_in_ct` along the gradient.
Eigen::Vector3d on_analytic_head(const Eigen::Vector3d& p_in_ct);

/// A closed mesh of the surface; vertices on it to 1e-6 mm; edges of about `edge_mm`.
TriangleMesh analytic_head_mesh(double edge_mm = 2);

/// A table over `mesh`, made the slow and obvious way (independent of segmentation): distance field from the analytic
/// function, pointers by brute force over the skin points within reach. Voxels of `voxel_mm`.
SkinLut analytic_head_lut(double voxel_mm = 2, double margin_mm = 40);

/// Points of the surface that are seen from `eye_in_ct` within `width_mm` round the middle of the view, with outward
/// normals, at most `count`; in ct (move them yourself).
PointCloud view_of_analytic_head(const Eigen::Vector3d& eye_in_ct, double width_mm, int count, unsigned seed);

}  // namespace planlight::test
