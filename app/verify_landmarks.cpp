#include "app/verify_landmarks.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "projection/stroke_places.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr double kReach_mm = 8, kSteepest = 0.9, kRim_px = 30;

/// How much the skin bends outwards round a place: the mean turn of its normal, radians; negative in a hollow.
double bend_at(const SkinSurface& skin, const SkinSurface::Point& at) {
    constexpr int kWays = 6;
    const Vector3d n = at.normal_in_ct, a = n.unitOrthogonal(), b = n.cross(a);
    double sum = 0;
    for (int k = 0; k < kWays; ++k) {
        const double angle = 2 * std::numbers::pi * k / kWays;
        const Vector3d way = std::cos(angle) * a + std::sin(angle) * b;
        sum += skin.nearest(at.p_in_ct + kReach_mm * way).normal_in_ct.dot(way) / kWays;
    }
    return sum;
}

bool well_inside(const CameraModel& device, const Vector3d& p_in_rig) {
    const auto pixel = project(device, p_in_rig);
    return pixel && pixel->x() > kRim_px && pixel->y() > kRim_px && pixel->x() < device.width - kRim_px &&
           pixel->y() < device.height - kRim_px;
}

}  // namespace

std::vector<Vector3d> landmarks_to_verify(const SkinSurface& skin, const RigCalibration& rig,
                                          const RigidTransform& rig_from_ct, double apart_mm) {
    constexpr std::size_t kLookedAt = 1500;
    const auto& vertices = skin.mesh().vertices_in_ct;
    const std::size_t step = std::max<std::size_t>(1, vertices.size() / (4 * kLookedAt));
    std::vector<std::pair<double, Vector3d>> bends;
    for (std::size_t i = 0; i < vertices.size() && bends.size() < kLookedAt; i += step) {
        const Vector3d p_in_rig = rig_from_ct * vertices[i];
        if (!well_inside(rig.projector, p_in_rig) || !well_inside(rig.left_camera, p_in_rig) ||
            !well_inside(rig.right_camera, p_in_rig))
            continue;
        const SkinSurface::Point at = skin.nearest(vertices[i]);
        StrokePlace place;
        place.p_in_ct = at.p_in_ct;
        place.normal_in_ct = at.normal_in_ct;
        const auto seen = [&](const CameraModel& device) {
            return freely_seen(place, skin, device, rig_from_ct, kSteepest);
        };
        if (!skin.real_skin(at) || !seen(rig.projector) || !seen(rig.left_camera) || !seen(rig.right_camera)) continue;
        bends.emplace_back(bend_at(skin, at), at.p_in_ct);
    }
    std::sort(bends.begin(), bends.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<Vector3d> found;
    for (const auto& [bend, p] : bends) {
        const bool apart =
            std::all_of(found.begin(), found.end(), [&](const Vector3d& q) { return (p - q).norm() >= apart_mm; });
        if (apart) found.push_back(p);
        if (found.size() == 2) break;
    }
    return found;
}

std::string words_of_place(const SkinSurface& skin, const Vector3d& place_in_ct) {
    constexpr double kClearly = 0.35;  // of the way from the middle to the farthest skin
    Eigen::AlignedBox3d box;
    for (const auto& vertex : skin.mesh().vertices_in_ct) box.extend(Vector3d(vertex));
    const Vector3d off = (place_in_ct - box.center()).cwiseQuotient(box.sizes() / 2);  // LPS
    std::string words;
    const auto add = [&](double share, const char* positive, const char* negative) {
        if (std::abs(share) < kClearly) return;
        words += (words.empty() ? "" : ", ") + std::string(share > 0 ? positive : negative);
    };
    add(off.y(), "at the back of the head", "at the front of the head");
    add(off.x(), "on the patient's left", "on the patient's right");
    add(off.z(), "towards the crown", "towards the neck");
    return words;
}

}  // namespace planlight
