#include "registration/simulation/true_surface.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "registration/simulation/ct_field.h"
#include "registration/simulation/iso_mesh.h"

namespace planlight::simulation {

using Eigen::Vector3d;
using Eigen::Vector3f;

struct TrueSurface::Parts {
    CtField field;
    IsoMesh mesh;
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
    Vector3d low = Vector3d::Constant(std::numeric_limits<double>::max()), high = -low;

    Parts(const Volume& volume, double threshold) : field(volume, threshold), mesh(iso_mesh(field)) {}
    ~Parts() {
        if (scene) rtcReleaseScene(scene);
        if (device) rtcReleaseDevice(device);
    }
    Parts(const Parts&) = delete;
    Parts& operator=(const Parts&) = delete;

    Vector3d normal(std::uint32_t triangle, float u, float v) const {
        const auto& t = mesh.triangles[triangle];
        return ((1 - u - v) * mesh.normals_in_ct[t[0]] + u * mesh.normals_in_ct[t[1]] + v * mesh.normals_in_ct[t[2]])
            .cast<double>()
            .normalized();
    }
};

namespace {

/// Closest point of triangle abc (Ericson, Real-Time Collision Detection, 5.1.5).
Vector3f closest_on_triangle(const Vector3f& p, const Vector3f& a, const Vector3f& b, const Vector3f& c) {
    const Vector3f ab = b - a, ac = c - a, ap = p - a;
    const float d1 = ab.dot(ap), d2 = ac.dot(ap);
    if (d1 <= 0 && d2 <= 0) return a;
    const Vector3f bp = p - b;
    const float d3 = ab.dot(bp), d4 = ac.dot(bp);
    if (d3 >= 0 && d4 <= d3) return b;
    const float vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
    const Vector3f cp = p - c;
    const float d5 = ab.dot(cp), d6 = ac.dot(cp);
    if (d6 >= 0 && d5 <= d6) return c;
    const float vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
    const float va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
    const float scale = 1 / (va + vb + vc);
    return a + vb * scale * ab + vc * scale * ac;
}

struct NearestQuery {
    const IsoMesh* mesh;
    Vector3f p;
    float best = std::numeric_limits<float>::max();
    Vector3f point = Vector3f::Zero();
    std::uint32_t triangle = 0;
};

bool consider_triangle(RTCPointQueryFunctionArguments* arguments) {
    auto& query = *static_cast<NearestQuery*>(arguments->userPtr);
    const auto& t = query.mesh->triangles[arguments->primID];
    const auto& v = query.mesh->vertices_in_ct;
    const Vector3f q = closest_on_triangle(query.p, v[t[0]], v[t[1]], v[t[2]]);
    const float d = (q - query.p).norm();
    if (d >= query.best) return false;
    query.best = arguments->query->radius = d;
    query.point = q;
    query.triangle = arguments->primID;
    return true;
}

/// Where along the ray the field is zero, near `t`: secant steps; `t` itself when they do not settle.
double refine_along(const CtField& field, const Vector3d& origin, const Vector3d& direction, double t) {
    constexpr double kFurthest_mm = 0.8, kSettled_mm = 2e-4;
    double a = t, fa = field.above(origin + a * direction);
    if (fa == 0) return t;
    double b = fa > 0 ? a - 0.05 : a + 0.05, fb = field.above(origin + b * direction);
    for (int i = 0; i < 8; ++i) {
        if (fa == fb) break;
        const double c = std::clamp(b - fb * (b - a) / (fb - fa), t - kFurthest_mm, t + kFurthest_mm);
        if (std::abs(c - b) < kSettled_mm) return c;
        a = b;
        fa = fb;
        b = c;
        fb = field.above(origin + b * direction);
    }
    return t;
}

}  // namespace

TrueSurface::TrueSurface(const Volume& volume, double threshold) : parts_(std::make_unique<Parts>(volume, threshold)) {
    auto& mesh = parts_->mesh;
    if (mesh.triangles.empty()) throw std::invalid_argument("no head surface is in the volume at this threshold");
    for (const auto& t : mesh.triangles)
        for (const auto v : t) {
            parts_->low = parts_->low.cwiseMin(mesh.vertices_in_ct[v].cast<double>());
            parts_->high = parts_->high.cwiseMax(mesh.vertices_in_ct[v].cast<double>());
        }
    parts_->device = rtcNewDevice(nullptr);
    if (!parts_->device) throw std::runtime_error("no ray tracing device");
    parts_->scene = rtcNewScene(parts_->device);
    rtcSetSceneFlags(parts_->scene, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(parts_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                             mesh.vertices_in_ct.size());
    std::copy_n(mesh.vertices_in_ct.data()->data(), 3 * mesh.vertices_in_ct.size(), static_cast<float*>(vertices));
    void* triangles = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                              3 * sizeof(std::uint32_t), mesh.triangles.size());
    std::copy_n(mesh.triangles.data()->data(), 3 * mesh.triangles.size(), static_cast<std::uint32_t*>(triangles));
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(parts_->scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(parts_->scene);
}

TrueSurface::~TrueSurface() = default;

std::optional<TrueSurface::Hit> TrueSurface::first_hit(const Vector3d& origin, const Vector3d& direction) const {
    RTCRayHit ray{};
    const Vector3f o = origin.cast<float>(), d = direction.cast<float>();
    ray.ray.org_x = o.x();
    ray.ray.org_y = o.y();
    ray.ray.org_z = o.z();
    ray.ray.dir_x = d.x();
    ray.ray.dir_y = d.y();
    ray.ray.dir_z = d.z();
    ray.ray.tfar = std::numeric_limits<float>::infinity();
    ray.ray.mask = ~0U;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect1(parts_->scene, &context, &ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    const double t = refine_along(parts_->field, origin, direction, static_cast<double>(ray.ray.tfar));
    return Hit{origin + t * direction, parts_->normal(ray.hit.primID, ray.hit.u, ray.hit.v), t};
}

bool TrueSurface::in_shadow(const Vector3d& p, const Vector3d& normal, const Vector3d& light) const {
    constexpr double kOff_mm = 0.25;
    const Vector3d start = p + kOff_mm * (normal + (light - p).normalized());
    const Vector3d way = light - start;
    RTCRay ray{};
    const Vector3f o = start.cast<float>(), d = way.normalized().cast<float>();
    ray.org_x = o.x();
    ray.org_y = o.y();
    ray.org_z = o.z();
    ray.dir_x = d.x();
    ray.dir_y = d.y();
    ray.dir_z = d.z();
    ray.tfar = static_cast<float>(way.norm());
    ray.mask = ~0U;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(parts_->scene, &context, &ray);
    return ray.tfar < 0;
}

TrueSurface::Nearest TrueSurface::nearest(const Vector3d& p) const {
    NearestQuery query{&parts_->mesh, p.cast<float>()};
    RTCPointQuery where{};
    where.x = query.p.x();
    where.y = query.p.y();
    where.z = query.p.z();
    where.radius = std::numeric_limits<float>::infinity();
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(parts_->scene, &where, &context, consider_triangle, &query);

    const auto onto_field = [&](Vector3d x) {  // Newton along the field's gradient
        for (int i = 0; i < 12; ++i) {
            const Vector3d g = parts_->field.gradient(x);
            const double square = g.squaredNorm();
            if (square < 1e-6) break;
            Vector3d step = -parts_->field.above(x) / square * g;
            if (step.norm() > 0.3) step *= 0.3 / step.norm();
            x += step;
            if (step.norm() < 1e-6) break;
        }
        return x;
    };
    Vector3d x = onto_field(query.point.cast<double>());
    for (int i = 0; i < 6; ++i) {  // slide along the tangent plane towards the foot of p
        const Vector3d n = parts_->field.gradient(x).normalized();
        const Vector3d along = (p - x) - n * n.dot(p - x);
        const Vector3d next = onto_field(x + 0.7 * along);
        if ((p - next).norm() >= (p - x).norm() - 1e-6) break;
        x = next;
    }
    const Vector3d normal = (-parts_->field.smooth_gradient(x)).normalized();
    const double sign = parts_->field.above(p) > 0 ? -1 : 1;
    return {x, normal, sign * (p - x).norm()};
}

Vector3d TrueSurface::low_in_ct() const {
    return parts_->low;
}
Vector3d TrueSurface::high_in_ct() const {
    return parts_->high;
}
std::size_t TrueSurface::triangle_count() const {
    return parts_->mesh.triangles.size();
}

}  // namespace planlight::simulation
