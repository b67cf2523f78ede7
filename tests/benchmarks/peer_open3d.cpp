#include <open3d/geometry/KDTreeSearchParam.h>
#include <open3d/geometry/PointCloud.h>
#include <open3d/pipelines/registration/CorrespondenceChecker.h>
#include <open3d/pipelines/registration/FastGlobalRegistration.h>
#include <open3d/pipelines/registration/Feature.h>
#include <open3d/pipelines/registration/Registration.h>
#include <open3d/pipelines/registration/RobustKernel.h>
#include <open3d/pipelines/registration/TransformationEstimation.h>
#include <open3d/utility/Random.h>

#include <memory>

#include "tests/benchmarks/peer_matchers.h"

namespace planlight {
namespace {

namespace registration = open3d::pipelines::registration;
using Cloud = open3d::geometry::PointCloud;

std::shared_ptr<Cloud> cloud_of(const std::vector<Eigen::Vector3d>& points,
                                const std::vector<Eigen::Vector3d>& normals) {
    auto cloud = std::make_shared<Cloud>(points);
    cloud->normals_ = normals;
    return cloud;
}

RigidTransform rigid(const Eigen::Matrix4d& matrix) {
    RigidTransform result = RigidTransform::Identity();
    result.matrix() = matrix;
    return result;
}

/// A cloud thinned to voxels, with its features over five voxels.
struct Featured {
    std::shared_ptr<Cloud> cloud;
    std::shared_ptr<registration::Feature> feature;
};

Featured featured(const Cloud& cloud, double voxel_mm) {
    Featured result{cloud.VoxelDownSample(voxel_mm), nullptr};
    result.cloud->NormalizeNormals();
    result.feature =
        registration::ComputeFPFHFeature(*result.cloud, open3d::geometry::KDTreeSearchParamHybrid(5 * voxel_mm, 100));
    return result;
}

}  // namespace

std::vector<PeerMatcher> open3d_global(const PeerSkin& skin) {
    constexpr double kVoxel_mm = 3;
    const auto target = featured(*cloud_of(skin.points_in_ct, skin.normals_in_ct), kVoxel_mm);
    const auto ransac = [target](const PointCloud& scan, const RigidTransform&) {
        open3d::utility::random::Seed(1);
        const auto source = featured(*cloud_of(scan.points_in_rig, scan.normals_in_rig), kVoxel_mm);
        const registration::CorrespondenceCheckerBasedOnEdgeLength edges(0.9);
        const registration::CorrespondenceCheckerBasedOnDistance near(1.5 * kVoxel_mm);
        return rigid(registration::RegistrationRANSACBasedOnFeatureMatching(
                         *source.cloud, *target.cloud, *source.feature, *target.feature, false, 1.5 * kVoxel_mm,
                         registration::TransformationEstimationPointToPoint(false), 3, {edges, near},
                         registration::RANSACConvergenceCriteria(1000000, 0.999))
                         .transformation_);
    };
    const auto fgr = [target](const PointCloud& scan, const RigidTransform&) {
        open3d::utility::random::Seed(1);
        const auto source = featured(*cloud_of(scan.points_in_rig, scan.normals_in_rig), kVoxel_mm);
        const registration::FastGlobalRegistrationOption options(1.4, true, true, 1.5 * kVoxel_mm, 128, 0.95, 10000);
        return rigid(registration::FastGlobalRegistrationBasedOnFeatureMatching(
                         *source.cloud, *target.cloud, *source.feature, *target.feature, options)
                         .transformation_);
    };
    return {{"Open3D FPFH + RANSAC, 3 mm, 1M", ransac}, {"Open3D FGR, 3 mm, absolute scale", fgr}};
}

std::vector<PeerMatcher> open3d_icp(const PeerSkin& skin) {
    const auto target = cloud_of(skin.points_in_ct, skin.normals_in_ct);
    const auto plane = [target](const PointCloud& scan, const RigidTransform& start) {
        const auto source = cloud_of(scan.points_in_rig, {});
        return rigid(registration::RegistrationICP(*source, *target, 20, start.matrix(),
                                                   registration::TransformationEstimationPointToPlane(),
                                                   registration::ICPConvergenceCriteria(1e-7, 1e-7, 60))
                         .transformation_);
    };
    const auto two_stages = [target, plane](const PointCloud& scan, const RigidTransform& start) {
        const auto source = cloud_of(scan.points_in_rig, {});
        const auto tukey = std::make_shared<registration::TukeyLoss>(1.5);
        return rigid(registration::RegistrationICP(*source, *target, 2, plane(scan, start).matrix(),
                                                   registration::TransformationEstimationPointToPlane(tukey),
                                                   registration::ICPConvergenceCriteria(1e-7, 1e-7, 60))
                         .transformation_);
    };
    return {{"Open3D point to plane, 20 mm", plane}, {"Open3D point to plane, then Tukey 1.5 mm", two_stages}};
}

}  // namespace planlight
