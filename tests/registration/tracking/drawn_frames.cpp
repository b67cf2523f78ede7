#include "tests/registration/tracking/drawn_frames.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "registration/tracking/ellipse.h"
#include "registration/tracking/pair_markers.h"

namespace planlight::test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using simulation::Optics;
using simulation::Preset;

/// Stickers on a ball of 80 mm before the rig's working point, at least 28 mm apart.
std::vector<DrawnMarker> stickers(int count, std::mt19937& random) {
    std::normal_distribution<double> unit;
    std::vector<DrawnMarker> placed;
    for (int tries = 0; static_cast<int>(placed.size()) < count && tries < 10000; ++tries) {
        const Vector3d n = Vector3d(0.5 * unit(random), 0.5 * unit(random), -1).normalized();
        const DrawnMarker s{Vector3d(0, 0, 60) + 80 * n, n};
        bool apart = true;
        for (const DrawnMarker& other : placed) apart = apart && (other.centre - s.centre).norm() > 28;
        if (apart) placed.push_back(s);
    }
    return placed;
}

/// A disc of 4 mm radius as `find_markers` measures it: the ellipse's centre, with the noise that it states.
std::optional<MarkerObservation> measured(const Optics& camera, const DrawnMarker& s, double contrast,
                                          std::mt19937& random) {
    const Vector3d back = (camera.eye - s.centre).normalized();
    const double ratio = back.dot(s.normal);
    if (ratio < 0.45) return std::nullopt;
    std::vector<Vector2d> rim;
    const Vector3d a = s.normal.unitOrthogonal(), b = s.normal.cross(a);
    for (int i = 0; i < 32; ++i) {
        const double angle = 2 * std::numbers::pi * i / 32;
        rim.push_back(camera.pixel_of(s.centre + 4 * (std::cos(angle) * a + std::sin(angle) * b)));
    }
    std::vector<bool> used;
    const auto ellipse = fit_ellipse_to_points(rim, used);
    if (!ellipse) return std::nullopt;
    const Vector2d pixel = ellipse->centre;
    if (pixel.minCoeff() < 20 || pixel.x() > camera.columns - 20 || pixel.y() > camera.rows - 20) return std::nullopt;
    MarkerObservation seen;
    seen.radius_px = ellipse->half_axes().mean();
    seen.axis_ratio = ratio;
    seen.contrast = contrast;
    const double noise =
        std::hypot(1.2 * 2 * 2 / contrast / std::sqrt(std::numbers::pi * seen.radius_px * ratio), 0.004);
    seen.steady_px = 4 / 900. * seen.radius_px * ratio * std::sqrt(1 - ratio * ratio);
    seen.sigma_px = std::hypot(noise, seen.steady_px);
    std::normal_distribution<double> unit(0, noise);
    seen.pixel = pixel + Vector2d(unit(random), unit(random));
    return seen;
}

}  // namespace

DrawnRoom::DrawnRoom(Preset preset, std::mt19937& random) : rig(simulation::build_rig(preset, random)) {
    calibration = simulation::calibrated(rig, 1, random);
    contrast = std::uniform_real_distribution<double>(40, 150)(random);
    const int count = 4 + static_cast<int>(random() % 6);
    for (const DrawnMarker& s : stickers(count, random)) {
        const auto l = measured(rig.left_camera, s, contrast, random),
                   r = measured(rig.right_camera, s, contrast, random);
        if (!l || !r) continue;
        const auto marker = triangulate_marker(calibration, *l, *r);
        if (!marker) continue;
        const double steady = std::hypot(l->steady_px, r->steady_px), all = std::hypot(l->sigma_px, r->sigma_px);
        in_room.push_back(s);
        reference.push_back({marker->point_in_rig, marker->sigma_mm * std::sqrt(1 - steady * steady / (all * all))});
    }
}

DrawnFrame frame_of(const DrawnRoom& room, std::mt19937& random, int slipped, const Vector3d& slip) {
    std::normal_distribution<double> unit;
    std::uniform_real_distribution<double> share(0, 1);
    DrawnFrame frame;
    const double far = share(random), mm = far < 0.25 ? 0 : far < 0.6 ? 15 : 60, degrees = mm * 0.35;
    RigidTransform moved = RigidTransform::Identity();
    const Vector3d axis = Vector3d(unit(random), unit(random), unit(random)).normalized();
    moved.linear() = Eigen::AngleAxisd(degrees * share(random) * std::numbers::pi / 180, axis).toRotationMatrix();
    const Vector3d way =
        mm * std::cbrt(share(random)) * Vector3d(unit(random), unit(random), unit(random)).normalized();
    const Vector3d neck(0, 0, 60);
    moved.translation() = neck + way - moved.linear() * neck;
    const RigidTransform rig_from_room = room.rig.room_from_rig.inverse();
    frame.truth = rig_from_room * moved * room.rig.room_from_rig;

    const double pattern = share(random);
    const bool left_too = pattern < 0.7 || pattern > 0.85, right_too = pattern < 0.85;  // a third by one camera alone
    const double covered_by_both = share(random) < 0.5 ? 0 : share(random),
                 covered = share(random) < 0.6 ? 0 : 0.5 * share(random);
    int left = 0, right = 0;
    for (std::size_t k = 0; k < room.in_room.size(); ++k) {
        if (share(random) < covered_by_both) continue;
        const Vector3d centre = room.in_room[k].centre + (static_cast<int>(k) == slipped ? slip : Vector3d::Zero());
        const DrawnMarker s{moved * centre, moved.linear() * room.in_room[k].normal};
        for (const bool is_left : {true, false}) {
            if (!(is_left ? left_too : right_too) || share(random) < covered) continue;
            const auto seen =
                measured(is_left ? room.rig.left_camera : room.rig.right_camera, s, room.contrast, random);
            if (seen) frame.sightings.push_back({static_cast<int>(k), is_left, *seen}), ++(is_left ? left : right);
        }
    }
    const int seen = distinct_markers(frame.sightings);
    frame.kind = fmt::format("{}, {}, {}", left && right ? "both cameras" : "one camera  ",
                             seen < 4   ? "3 markers  "
                             : seen < 6 ? "4, 5 markers"
                                        : "6 to 9 markers",
                             mm < 1    ? "at the reference"
                             : mm < 20 ? "to 15 mm and 5 deg off"
                                       : "to 60 mm and 21 deg off");
    return frame;
}

std::vector<Vector3d> plan_of(const DrawnRoom& room, std::mt19937& random) {
    std::normal_distribution<double> unit;
    const Vector3d n = Vector3d(0.6 * unit(random), 0.6 * unit(random), -1).normalized(), a = n.unitOrthogonal(),
                   b = n.cross(a), entry = Vector3d(0, 0, 60) + 80 * n;
    std::vector<Vector3d> places;
    for (const Vector3d& p : {entry, Vector3d(entry + 15 * a), Vector3d(entry - 15 * a), Vector3d(entry + 15 * b),
                              Vector3d(entry - 15 * b)})
        places.push_back(room.rig.room_from_rig.inverse() * p);
    return places;
}

double largest_off(const RigidTransform& found, const RigidTransform& truth, const std::vector<Vector3d>& places) {
    double largest = 0;
    for (const Vector3d& p : places) largest = std::max(largest, (found * p - truth * p).norm());
    return largest;
}

std::string name_of(Preset preset) {
    return preset == Preset::paper ? "paper" : "modern";
}

}  // namespace planlight::test
