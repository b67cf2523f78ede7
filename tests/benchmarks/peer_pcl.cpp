#include <pcl/features/fpfh.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/point_types.h>
#include <pcl/registration/ia_ransac.h>
#include <pcl/registration/icp.h>
#include <pcl/registration/sample_consensus_prerejective.h>
#include <pcl/search/kdtree.h>

#include <cstdlib>

#include "tests/benchmarks/peer_matchers.h"

namespace planlight {
namespace {

using Point = pcl::PointNormal;
using Cloud = pcl::PointCloud<Point>;
using Features = pcl::PointCloud<pcl::FPFHSignature33>;

Cloud::Ptr cloud_of(const std::vector<Eigen::Vector3d>& points, const std::vector<Eigen::Vector3d>& normals) {
    Cloud::Ptr cloud(new Cloud);
    for (std::size_t i = 0; i < points.size(); ++i) {
        Point p;
        p.getVector3fMap() = points[i].cast<float>();
        p.getNormalVector3fMap() = normals[i].cast<float>();
        cloud->push_back(p);
    }
    return cloud;
}

RigidTransform rigid(const Eigen::Matrix4f& matrix) {
    RigidTransform result = RigidTransform::Identity();
    result.matrix() = matrix.cast<double>();
    return result;
}

struct Featured {
    Cloud::Ptr cloud{new Cloud};
    Features::Ptr features{new Features};
};

Featured featured(const Cloud::Ptr& cloud, float voxel_mm) {
    Featured result;
    pcl::VoxelGrid<Point> grid;
    grid.setInputCloud(cloud);
    grid.setLeafSize(voxel_mm, voxel_mm, voxel_mm);
    grid.filter(*result.cloud);
    for (Point& p : *result.cloud) p.getNormalVector3fMap().normalize();
    pcl::FPFHEstimation<Point, Point, pcl::FPFHSignature33> estimation;
    estimation.setInputCloud(result.cloud);
    estimation.setInputNormals(result.cloud);
    estimation.setRadiusSearch(5 * static_cast<double>(voxel_mm));
    estimation.compute(*result.features);
    return result;
}

template <class Icp>
PeerMatcher icp_of(const std::string& name, const Cloud::Ptr& target) {
    pcl::search::KdTree<Point>::Ptr tree(new pcl::search::KdTree<Point>);
    tree->setInputCloud(target);
    return {name, [target, tree](const PointCloud& scan, const RigidTransform& start) {
                Icp icp;
                icp.setInputTarget(target);
                icp.setSearchMethodTarget(tree, true);
                icp.setInputSource(cloud_of(scan.points_in_rig, scan.normals_in_rig));
                icp.setMaxCorrespondenceDistance(20);
                icp.setMaximumIterations(60);
                icp.setTransformationEpsilon(1e-10);
                icp.setEuclideanFitnessEpsilon(1e-8);
                Cloud moved;
                icp.align(moved, start.matrix().cast<float>());
                return rigid(icp.getFinalTransformation());
            }};
}

}  // namespace

std::vector<PeerMatcher> pcl_global(const PeerSkin& skin) {
    const Cloud::Ptr whole = cloud_of(skin.points_in_ct, skin.normals_in_ct);
    const Featured fine = featured(whole, 3), coarse = featured(whole, 4);
    const auto prerejective = [fine](const PointCloud& scan, const RigidTransform&) {
        std::srand(1);
        const Featured source = featured(cloud_of(scan.points_in_rig, scan.normals_in_rig), 3);
        pcl::SampleConsensusPrerejective<Point, Point, pcl::FPFHSignature33> match;
        match.setInputSource(source.cloud);
        match.setSourceFeatures(source.features);
        match.setInputTarget(fine.cloud);
        match.setTargetFeatures(fine.features);
        match.setMaximumIterations(300000);
        match.setNumberOfSamples(3);
        match.setCorrespondenceRandomness(5);
        match.setSimilarityThreshold(0.9F);
        match.setMaxCorrespondenceDistance(4.5);
        match.setInlierFraction(0.25F);
        Cloud moved;
        match.align(moved);
        return rigid(match.getFinalTransformation());
    };
    const auto initial_alignment = [coarse](const PointCloud& scan, const RigidTransform&) {
        std::srand(1);
        const Featured source = featured(cloud_of(scan.points_in_rig, scan.normals_in_rig), 4);
        pcl::SampleConsensusInitialAlignment<Point, Point, pcl::FPFHSignature33> match;
        match.setInputSource(source.cloud);
        match.setSourceFeatures(source.features);
        match.setInputTarget(coarse.cloud);
        match.setTargetFeatures(coarse.features);
        match.setMinSampleDistance(20);
        match.setMaxCorrespondenceDistance(10);
        match.setMaximumIterations(1000);
        Cloud moved;
        match.align(moved);
        return rigid(match.getFinalTransformation());
    };
    return {{"PCL FPFH + prerejective RANSAC, 3 mm, 300k", prerejective},
            {"PCL FPFH + SAC-IA, 4 mm, 1000", initial_alignment}};
}

std::vector<PeerMatcher> pcl_icp(const PeerSkin& skin) {
    const Cloud::Ptr target = cloud_of(skin.points_in_ct, skin.normals_in_ct);
    return {icp_of<pcl::IterativeClosestPoint<Point, Point>>("PCL point to point, 20 mm", target),
            icp_of<pcl::IterativeClosestPointWithNormals<Point, Point>>("PCL point to plane, 20 mm", target)};
}

}  // namespace planlight
