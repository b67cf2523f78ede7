#include "tests/registration/matching/trial_surface.h"

#include <embree3/rtcore.h>

#include <Eigen/Geometry>
#include <limits>
#include <stdexcept>

namespace planlight::test {

using Eigen::Vector3d;

struct TrialSurface::Parts {
    TriangleMesh mesh;
    Vector3d low = Vector3d::Constant(std::numeric_limits<double>::max()), high = -low;
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
    ~Parts() {
        if (scene) rtcReleaseScene(scene);
        if (device) rtcReleaseDevice(device);
    }
};

TrialSurface::TrialSurface(TriangleMesh mesh) : parts_(std::make_unique<Parts>()) {
    if (mesh.triangles.empty()) throw std::invalid_argument("the surface of the trial has no triangles");
    Parts& parts = *parts_;
    parts.mesh = std::move(mesh);
    for (const Vector3d& p : parts.mesh.vertices_in_ct) {
        parts.low = parts.low.cwiseMin(p);
        parts.high = parts.high.cwiseMax(p);
    }
    parts.device = rtcNewDevice("threads=1");
    parts.scene = rtcNewScene(parts.device);
    rtcSetSceneFlags(parts.scene, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(parts.device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 3 * sizeof(float), parts.mesh.vertices_in_ct.size()));
    for (const Vector3d& p : parts.mesh.vertices_in_ct)
        for (int axis = 0; axis < 3; ++axis) *vertices++ = static_cast<float>(p[axis]);
    auto* corners = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), parts.mesh.triangles.size()));
    for (const auto& triangle : parts.mesh.triangles)
        for (const auto corner : triangle) *corners++ = static_cast<std::uint32_t>(corner);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(parts.scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(parts.scene);
}

TrialSurface::~TrialSurface() = default;
TrialSurface::TrialSurface(TrialSurface&& other) noexcept = default;

std::optional<TrialSurface::Hit> TrialSurface::first_hit(const Vector3d& origin, const Vector3d& direction) const {
    RTCRayHit ray{};
    ray.ray.org_x = static_cast<float>(origin.x());
    ray.ray.org_y = static_cast<float>(origin.y());
    ray.ray.org_z = static_cast<float>(origin.z());
    ray.ray.dir_x = static_cast<float>(direction.x());
    ray.ray.dir_y = static_cast<float>(direction.y());
    ray.ray.dir_z = static_cast<float>(direction.z());
    ray.ray.tfar = std::numeric_limits<float>::infinity();
    ray.ray.mask = ~0U;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(parts_->scene, &context, &ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    const TriangleMesh& mesh = parts_->mesh;
    const auto& triangle = mesh.triangles[ray.hit.primID];
    std::array<Vector3d, 3> corner;
    for (std::size_t i = 0; i < 3; ++i) corner[i] = mesh.vertices_in_ct[static_cast<std::size_t>(triangle[i])];
    const double u = static_cast<double>(ray.hit.u), v = static_cast<double>(ray.hit.v);
    Hit hit;
    hit.p_in_ct = (1 - u - v) * corner[0] + u * corner[1] + v * corner[2];
    hit.normal_in_ct = (corner[1] - corner[0]).cross(corner[2] - corner[0]).normalized();
    if (!mesh.flags.empty()) {
        const std::size_t nearest = 1 - u - v > std::max(u, v) ? 0 : u > v ? 1 : 2;
        hit.flag = mesh.flags[static_cast<std::size_t>(triangle[nearest])];
    }
    return hit;
}

Vector3d TrialSurface::low_in_ct() const {
    return parts_->low;
}
Vector3d TrialSurface::high_in_ct() const {
    return parts_->high;
}
const TriangleMesh& TrialSurface::mesh() const {
    return parts_->mesh;
}

}  // namespace planlight::test
