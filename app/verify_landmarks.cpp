#include "app/verify_landmarks.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "planning_io/types/even_direction.h"
#include "projection/render_drawing.h"
#include "projection/stroke_places.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr double kReach_mm = 8, kSteepest = 0.9, kRim_px = 30;
/// Of the ring: to where the cameras measure its light well and an eye sees it as a ring, then as far as it is lit.
constexpr std::array kSteepestOfRing{1.05, RenderSettings{}.steepest};
constexpr double kEnoughOfRing = 0.85;  ///< lit: a person sees then where its middle is, and the cameras measure it

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

/// How much of the ring round a place the projector can light, or the camera that sees least of it can see, up to that
/// angle to the skin's normal.
double share_of_ring(const SkinSurface& skin, const SkinSurface::Point& at, const RigCalibration& rig,
                     const RigidTransform& rig_from_ct, double steepest) {
    constexpr int kPlaces = 12;
    const std::array devices{&rig.projector, &rig.left_camera, &rig.right_camera};
    const Vector3d a = at.normal_in_ct.unitOrthogonal(), b = at.normal_in_ct.cross(a);
    std::array<int, devices.size()> reached{};
    for (int k = 0; k < kPlaces; ++k) {
        const double angle = 2 * std::numbers::pi * k / kPlaces;
        const auto there = skin.walk(at, kLandmarkRing_mm / 2 * (std::cos(angle) * a + std::sin(angle) * b));
        if (!there || !skin.real_skin(*there)) continue;
        StrokePlace place;
        place.p_in_ct = there->p_in_ct;
        place.normal_in_ct = there->normal_in_ct;
        for (std::size_t i = 0; i < devices.size(); ++i)
            reached[i] += freely_seen(place, skin, *devices[i], rig_from_ct, steepest) ? 1 : 0;
    }
    return static_cast<double>(*std::ranges::min_element(reached)) / kPlaces;
}

/// A place of the skin that the devices see, how far it bends outwards there, and how much of the ring can be lit and
/// seen.
struct Candidate {
    double bend = 0;
    SkinSurface::Point at;
    double of_ring = 0;
};

/// Takes the first two of them that are far enough from each other and from what is there.
template <typename Wanted>
void take(std::vector<Candidate>& candidates, double apart_mm, std::vector<Vector3d>& found, const Wanted& wanted) {
    for (Candidate& one : candidates) {
        if (found.size() == 2) return;
        const bool apart = std::all_of(found.begin(), found.end(),
                                       [&](const Vector3d& q) { return (one.at.p_in_ct - q).norm() >= apart_mm; });
        if (apart && wanted(one)) found.push_back(one.at.p_in_ct);
    }
}

}  // namespace

std::vector<Vector3d> landmarks_to_verify(const SkinSurface& skin, const RigCalibration& rig,
                                          const RigidTransform& rig_from_ct, double apart_mm) {
    constexpr std::size_t kLookedAt = 1500;
    const auto& vertices = skin.mesh().vertices_in_ct;
    const std::size_t step = std::max<std::size_t>(1, vertices.size() / (4 * kLookedAt));
    std::vector<Candidate> candidates;
    for (std::size_t i = 0; i < vertices.size() && candidates.size() < kLookedAt; i += step) {
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
        candidates.push_back({bend_at(skin, at), at});
    }
    std::sort(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) { return a.bend > b.bend; });
    std::vector<Vector3d> found;
    for (const double steepest : kSteepestOfRing)
        take(candidates, apart_mm, found, [&](Candidate& one) {
            one.of_ring = share_of_ring(skin, one.at, rig, rig_from_ct, steepest);
            return one.of_ring >= kEnoughOfRing;
        });
    if (found.size() < 2) {  // every place was asked: the best of what there is
        std::stable_sort(candidates.begin(), candidates.end(),
                         [](const auto& a, const auto& b) { return a.of_ring > b.of_ring; });
        take(candidates, apart_mm, found, [](const Candidate&) { return true; });
    }
    return found;
}

Vector3d free_view_of(const SkinSurface& skin, const Vector3d& place_in_ct) {
    constexpr int kWays = 400, kOfRing = 6;
    constexpr double kFar_mm = 1000, kSame_mm = 1.5;
    constexpr double kLowest = -0.5, kHighest = 0.9;  // radians above the horizontal
    const SkinSurface::Point at = skin.nearest(place_in_ct);
    const Vector3d a = at.normal_in_ct.unitOrthogonal(), b = at.normal_in_ct.cross(a);
    std::vector<Vector3d> looked_at{at.p_in_ct};
    for (int k = 0; k < kOfRing; ++k) {
        const double angle = 2 * std::numbers::pi * k / kOfRing;
        if (const auto p = skin.walk(at, kLandmarkRing_mm / 2 * (std::cos(angle) * a + std::sin(angle) * b)))
            looked_at.push_back(p->p_in_ct);
    }
    const double level = std::hypot(at.normal_in_ct.x(), at.normal_in_ct.y());
    const double elevation = std::clamp(std::atan2(at.normal_in_ct.z(), level), kLowest, kHighest);
    const Vector3d straight = level > 1e-6
                                  ? Vector3d(std::cos(elevation) * at.normal_in_ct.x() / level,
                                             std::cos(elevation) * at.normal_in_ct.y() / level, std::sin(elevation))
                                  : Vector3d(0, -std::cos(elevation), std::sin(elevation));
    std::vector<Vector3d> ways{straight};
    for (int i = 0; i < kWays; ++i) ways.push_back(even_direction(i, kWays, std::sin(kLowest), std::sin(kHighest)));
    std::stable_sort(ways.begin() + 1, ways.end(), [&](const Vector3d& u, const Vector3d& v) {
        return u.dot(at.normal_in_ct) > v.dot(at.normal_in_ct);
    });
    Vector3d best = straight;
    std::size_t most = 0;
    for (const Vector3d& way : ways) {
        const auto seen = static_cast<std::size_t>(std::ranges::count_if(looked_at, [&](const Vector3d& p) {
            const auto hit = skin.first_hit({p + kFar_mm * way, -way});
            return hit && (hit->p_in_ct - p).norm() < kSame_mm;
        }));
        if (seen > most) most = seen, best = way;
        if (seen == looked_at.size()) break;
    }
    return best;
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
