#include "registration/simulation/markers.h"

#include <algorithm>
#include <cmath>

namespace planlight::simulation {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double kClearOfPlan_mm = 15, kLeastApart_mm = 25, kReach_mm = 95;
constexpr double kSteepest = 0.66 /* cos 48.7 degrees */, kSteepestOfFew = 0.5 /* cos 60 degrees */;
constexpr std::size_t kFewest =
    6;  ///< five are needed: nobody leaves it at fewer, rather pastes where the skin is steep

bool sees(const TrueSurface& skin, const Optics& device, const TrueSurface::Hit& at, double steepest) {
    constexpr double kMargin_px = 40;
    const Vector3d way = device.eye - at.p_in_ct;
    if (at.normal_in_ct.dot(way.normalized()) < steepest) return false;
    const Vector2d pixel = device.pixel_of(at.p_in_ct);
    if (pixel.x() < kMargin_px || pixel.y() < kMargin_px || pixel.x() > device.columns - kMargin_px ||
        pixel.y() > device.rows - kMargin_px)
        return false;
    return !skin.in_shadow(at.p_in_ct, at.normal_in_ct, device.eye);
}

/// A sticker would lie well: the skin under its rim hardly bends away, and is no cut end of the scan.
bool lies_flat(const TrueSurface& skin, const TrueSurface::Hit& at) {
    constexpr double kRim_mm = 10, kBend = 0.94 /* cos 20 degrees */, kFromEnd_mm = 14;
    if (at.p_in_ct.z() < skin.low_in_ct().z() + kFromEnd_mm || at.p_in_ct.z() > skin.high_in_ct().z() - kFromEnd_mm)
        return false;
    const Vector3d a = at.normal_in_ct.unitOrthogonal(), b = at.normal_in_ct.cross(a);
    for (int i = 0; i < 8; ++i) {
        const Vector3d way = std::cos(i * M_PI / 4) * a + std::sin(i * M_PI / 4) * b;
        const auto rim = skin.nearest(at.p_in_ct + kRim_mm * way);
        if (rim.normal_in_ct.dot(at.normal_in_ct) < kBend || std::abs(rim.signed_mm) > 3) return false;
    }
    return true;
}

bool clear_of(const Vector3d& p, const std::vector<Vector3d>& others, double distance_mm) {
    return std::none_of(others.begin(), others.end(), [&](const Vector3d& q) { return (p - q).norm() < distance_mm; });
}

}  // namespace

std::vector<Sticker> place_stickers(const TrueSurface& skin, const WorkRegion& region,
                                    const std::vector<Vector3d>& keep_clear, const Optics& left, const Optics& right,
                                    const Optics& projector, int count, std::mt19937& random) {
    std::uniform_real_distribution<double> across(0, projector.columns - 1), down(0, projector.rows - 1);
    const auto all_see = [&](const TrueSurface::Hit& hit, double steepest) {
        return sees(skin, projector, hit, steepest) && sees(skin, left, hit, steepest) &&
               sees(skin, right, hit, steepest);
    };
    std::vector<TrueSurface::Hit> places, steep_places;
    for (int tries = 0; tries < 4000 && places.size() < 300; ++tries) {
        const double u = across(random), v = down(random);
        const auto hit = skin.first_hit(projector.eye, projector.direction_of({u, v}));
        if (!hit || (hit->p_in_ct - region.centre_in_ct).norm() > kReach_mm) continue;
        if (!clear_of(hit->p_in_ct, keep_clear, kClearOfPlan_mm)) continue;
        if (!all_see(*hit, kSteepestOfFew) || !lies_flat(skin, *hit)) continue;
        (all_see(*hit, kSteepest) ? places : steep_places).push_back(*hit);
    }
    std::vector<Sticker> stickers;
    std::vector<Vector3d> centres;
    const auto paste = [&](const std::vector<TrueSurface::Hit>& on, std::size_t most) {
        for (double apart = 55; apart >= kLeastApart_mm; apart -= 5)  // as far apart as the skin allows
            for (const auto& place : on) {
                if (stickers.size() >= most) return;
                if (!clear_of(place.p_in_ct, centres, apart)) continue;
                stickers.push_back({place.p_in_ct, place.normal_in_ct});
                centres.push_back(place.p_in_ct);
            }
    };
    const auto wanted = static_cast<std::size_t>(std::max(count, 0));
    paste(places, wanted);
    paste(steep_places, std::min(kFewest, wanted));
    return stickers;
}

}  // namespace planlight::simulation
