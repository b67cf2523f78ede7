#include "app/live/clickable_scan.h"

#include <Eigen/Geometry>

#include "registration/scan/clean/surface_triangles.h"

namespace planlight {
namespace {

/// The axes (rows: right, down, forward) of a device that looks at the skin from before it.
Eigen::Matrix3d from_before(const PointCloud& cloud) {
    Eigen::Vector3d forward = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& n : cloud.normals_in_rig) forward -= n;
    forward = forward.norm() > 1e-9 ? forward.normalized() : Eigen::Vector3d::UnitZ();
    Eigen::Vector3d right = Eigen::Vector3d::UnitY().cross(forward);
    if (right.norm() < 0.1) right = Eigen::Vector3d::UnitX().cross(forward);
    right.normalize();
    Eigen::Matrix3d axes;
    axes << right.transpose(), forward.cross(right).transpose(), forward.transpose();
    return axes;
}

}  // namespace

std::shared_ptr<const ClickableScan> clickable_scan(const PointCloud& cloud, const CameraModel* seen_by) {
    TriangleMesh mesh;
    mesh.triangles = surface_triangles(cloud);
    if (mesh.triangles.empty()) return nullptr;
    Eigen::Matrix3d shown_from_device;  // right, forward, up
    shown_from_device << 1, 0, 0, 0, 0, 1, 0, -1, 0;
    const Eigen::Matrix3d device_from_rig =
        seen_by ? Eigen::Matrix3d(seen_by->device_from_rig.linear()) : from_before(cloud);
    RigidTransform shown_from_rig = RigidTransform::Identity();
    shown_from_rig.linear() = shown_from_device * device_from_rig;
    mesh.vertices_in_ct.reserve(cloud.size());
    for (const Eigen::Vector3d& p : cloud.points_in_rig)  // unused ones that are not finite would be refused
        mesh.vertices_in_ct.emplace_back(p.allFinite() ? shown_from_rig * p : Eigen::Vector3d::Zero());
    if (cloud.normals_in_rig.size() == cloud.size())
        for (const Eigen::Vector3d& n : cloud.normals_in_rig)
            mesh.normals_in_ct.emplace_back(shown_from_rig.linear() * n);
    return std::make_shared<ClickableScan>(ClickableScan{SkinSurface(std::move(mesh)), shown_from_rig});
}

}  // namespace planlight
