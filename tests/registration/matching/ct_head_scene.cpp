#include "tests/registration/matching/ct_head_scene.h"

#include <Eigen/Geometry>
#include <cmath>
#include <memory>
#include <random>

#include "planning_io/volume/read_volume.h"
#include "segmentation/build_skin_lut.h"
#include "segmentation/segment_skin.h"
#include "tests/support/test_data.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

constexpr double kSkin_hu = -300;

/// Trilinear; air outside the volume.
double field(const Volume& volume, const Vector3d& voxel) {
    if (!(voxel.minCoeff() >= 0)) return -1000;
    const int i = static_cast<int>(voxel.x()), j = static_cast<int>(voxel.y()), k = static_cast<int>(voxel.z());
    if (i + 1 >= volume.size[0] || j + 1 >= volume.size[1] || k + 1 >= volume.size[2]) return -1000;
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const int a = corner & 1, b = (corner >> 1) & 1, c = corner >> 2;
        const double wx = a ? voxel.x() - i : i + 1 - voxel.x();
        const double wy = b ? voxel.y() - j : j + 1 - voxel.y();
        const double wz = c ? voxel.z() - k : k + 1 - voxel.z();
        sum += wx * wy * wz * static_cast<double>(volume.at(i + a, j + b, k + c));
    }
    return sum;
}

}  // namespace

const CtHead* ct_head() {
    static const std::unique_ptr<CtHead> head = []() -> std::unique_ptr<CtHead> {
        const auto file = example_patient();
        if (!file) return nullptr;
        auto made = std::make_unique<CtHead>();
        made->volume = read_volume(*file);
        SkinSettings settings;
        settings.threshold =
            kSkin_hu;  // the same surface as the scan's, or the registration would be shifted by the difference
        const SkinMask mask = segment_skin(made->volume, settings);
        made->lut = build_skin_lut(triangulate_skin(made->volume, mask, settings));
        return made;
    }();
    return head.get();
}

PointCloud scan_of_ct(const Volume& volume, const Vector3d& eye_in_ct, double width_mm, int points, unsigned seed) {
    constexpr double kStep_mm = 0.7;
    const Eigen::Affine3d voxel_from_ct = volume.ct_from_voxel.inverse();
    const Vector3d size(volume.size[0], volume.size[1], volume.size[2]);
    const Vector3d middle = volume.ct_from_voxel * Vector3d(0.5 * size);
    const double end_slices = 3 / volume.spacing_mm().z();
    const Vector3d forward = (middle - eye_in_ct).normalized();
    const Vector3d right = forward.unitOrthogonal(), down = forward.cross(right);
    const double near_mm = (middle - eye_in_ct).norm() - 180, far_mm = near_mm + 260;
    const auto at = [&](const Vector3d& p) { return field(volume, voxel_from_ct * p); };
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> offset(-width_mm / 2, width_mm / 2);
    PointCloud cloud;
    for (int tries = 0; tries < 6 * points && static_cast<int>(cloud.size()) < points; ++tries) {
        const double across = offset(random), along = offset(random);
        const Vector3d direction = (middle + across * right + along * down - eye_in_ct).normalized();
        double t = near_mm;
        while (t < far_mm && at(eye_in_ct + t * direction) < kSkin_hu) t += kStep_mm;
        if (t >= far_mm || t == near_mm) continue;
        double low = t - kStep_mm, high = t;
        for (int i = 0; i < 20; ++i)
            (at(eye_in_ct + 0.5 * (low + high) * direction) < kSkin_hu ? low : high) = 0.5 * (low + high);
        const Vector3d p = eye_in_ct + high * direction;
        const double slice = (voxel_from_ct * p).z();
        if (slice < end_slices || slice > size.z() - 1 - end_slices) continue;
        Vector3d gradient;
        for (int axis = 0; axis < 3; ++axis)
            gradient[axis] = at(p + Vector3d::Unit(axis)) - at(p - Vector3d::Unit(axis));
        const Vector3d normal = -gradient.normalized();
        if (!normal.allFinite() || normal.dot(direction) > -0.26) continue;
        cloud.points_in_rig.push_back(p);
        cloud.normals_in_rig.push_back(normal);
    }
    return cloud;
}

PointCloud ct_view(const CtHead& head, unsigned i, double width_mm, int points) {
    static const std::vector<Vector3d> kDirections{
        {0.1, -1, 0.15}, {0.8, -0.7, 0.1}, {-0.75, -0.7, 0.2}, {1, -0.25, 0.1}};
    const Vector3d size(head.volume.size[0], head.volume.size[1], head.volume.size[2]);
    const Vector3d middle = head.volume.ct_from_voxel * Vector3d(0.5 * size);
    return scan_of_ct(head.volume, middle + 900 * kDirections[i % kDirections.size()].normalized(), width_mm, points,
                      i);
}

PointCloud twisted(PointCloud cloud, double rad_per_mm) {
    Vector3d middle = Vector3d::Zero();
    for (const Vector3d& p : cloud.points_in_rig) middle += p / static_cast<double>(cloud.size());
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        Vector3d& p = cloud.points_in_rig[i];
        const Eigen::AngleAxisd turn(rad_per_mm * (p.z() - middle.z()), Vector3d::UnitZ());
        const Vector3d axis(middle.x(), middle.y() + 70, p.z());
        p = axis + turn * (p - axis);
        cloud.normals_in_rig[i] = turn * cloud.normals_in_rig[i];
    }
    return cloud;
}

std::vector<double> light_off_mm(const RigidTransform& patient_from_ct, const PointCloud& of_ct,
                                 const PointCloud& in_rig) {
    std::vector<double> off_mm;
    for (std::size_t k = 0; k < of_ct.size(); ++k)
        off_mm.push_back((patient_from_ct * of_ct.points_in_rig[k] - in_rig.points_in_rig[k]).norm());
    return off_mm;
}

}  // namespace planlight::test
