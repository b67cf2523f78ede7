#include "registration/simulation/dressed_surface.h"

#include <embree3/rtcore.h>

#include <limits>

namespace planlight::simulation {

using Eigen::Vector3d;
using Eigen::Vector3f;

struct DressedSurface::Things {
    ThingsMesh mesh;
    RTCDevice device = rtcNewDevice(nullptr);
    RTCScene scene = rtcNewScene(device);
    Vector3f low, high;
    std::vector<Vector3f> corner_normals;

    explicit Things(ThingsMesh given) : mesh(std::move(given)) {
        low = high = mesh.vertices_in_ct.front();
        for (const Vector3f& p : mesh.vertices_in_ct) low = low.cwiseMin(p), high = high.cwiseMax(p);
        corner_normals.assign(mesh.vertices_in_ct.size(), Vector3f::Zero());
        for (const auto& t : mesh.triangles)
            for (const std::uint32_t corner : t) corner_normals[corner] += flat_normal(t);
        for (Vector3f& n : corner_normals) n.normalize();
        rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
        RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
        auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices_in_ct.size()));
        for (const Vector3f& p : mesh.vertices_in_ct)
            for (int axis = 0; axis < 3; ++axis) *vertices++ = p[axis];
        auto* corners = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), mesh.triangles.size()));
        for (const auto& triangle : mesh.triangles)
            for (const std::uint32_t corner : triangle) *corners++ = corner;
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene);
    }
    ~Things() {
        rtcReleaseScene(scene);
        rtcReleaseDevice(device);
    }
    Things(const Things&) = delete;
    Things& operator=(const Things&) = delete;

    /// Twice its area long.
    Vector3f flat_normal(const std::array<std::uint32_t, 3>& t) const {
        const Vector3f &a = mesh.vertices_in_ct[t[0]], &b = mesh.vertices_in_ct[t[1]], &c = mesh.vertices_in_ct[t[2]];
        return (b - a).cross(c - a);
    }
    /// Smooth over the corners, but for metal, which has edges.
    Vector3d normal(std::uint32_t triangle, float u, float v) const {
        const auto& t = mesh.triangles[triangle];
        if (mesh.made_of[triangle] == Material::metal) return flat_normal(t).cast<double>().normalized();
        return ((1 - u - v) * corner_normals[t[0]] + u * corner_normals[t[1]] + v * corner_normals[t[2]])
            .cast<double>()
            .normalized();
    }
};

namespace {

template <class Ray>
void set_ray(Ray& ray, const Vector3d& from, const Vector3d& way) {
    const Vector3f o = from.cast<float>(), d = way.cast<float>();
    ray.org_x = o.x(), ray.org_y = o.y(), ray.org_z = o.z();
    ray.dir_x = d.x(), ray.dir_y = d.y(), ray.dir_z = d.z();
    ray.mask = ~0U;
}

}  // namespace

DressedSurface::DressedSurface(const TrueSurface& head) : head_(head) {}
DressedSurface::~DressedSurface() = default;

void DressedSurface::lay(ThingsMesh things) {
    things_ = things.triangles.empty() ? nullptr : std::make_unique<Things>(std::move(things));
}

std::optional<Surface::Hit> DressedSurface::first_hit(const Vector3d& origin, const Vector3d& direction) const {
    std::optional<Hit> hit = head_.first_hit(origin, direction);
    if (!things_) return hit;
    RTCRayHit ray{};
    set_ray(ray.ray, origin, direction);
    ray.ray.tfar = hit ? static_cast<float>(hit->distance_mm) : std::numeric_limits<float>::infinity();
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(things_->scene, &context, &ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return hit;
    const double t = static_cast<double>(ray.ray.tfar);
    Vector3d normal = things_->normal(ray.hit.primID, ray.hit.u, ray.hit.v);
    if (normal.dot(direction) > 0) normal = -normal;  // cloth has two sides
    return Hit{origin + t * direction, normal, t, things_->mesh.made_of[ray.hit.primID]};
}

bool DressedSurface::in_shadow(const Vector3d& p, const Vector3d& normal, const Vector3d& light) const {
    constexpr double kOff_mm = 0.25;
    if (head_.in_shadow(p, normal, light)) return true;
    if (!things_) return false;
    const Vector3d start = p + kOff_mm * (normal + (light - p).normalized());
    RTCRay ray{};
    set_ray(ray, start, (light - start).normalized());
    ray.tfar = static_cast<float>((light - start).norm());
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(things_->scene, &context, &ray);
    return ray.tfar < 0;
}

Vector3d DressedSurface::low_in_ct() const {
    return things_ ? head_.low_in_ct().cwiseMin(things_->low.cast<double>()) : head_.low_in_ct();
}
Vector3d DressedSurface::high_in_ct() const {
    return things_ ? head_.high_in_ct().cwiseMax(things_->high.cast<double>()) : head_.high_in_ct();
}

}  // namespace planlight::simulation
