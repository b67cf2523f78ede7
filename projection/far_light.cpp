#include "projection/far_light.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "planning_io/types/statistics.h"
#include "projection/bilinear.h"
#include "projection/biquadratic.h"

namespace planlight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::size_t kStencil = 9;       // shifts of -1, 0, 1 reach in both directions, rows first
constexpr std::size_t kPlacesAlong = 3;   // of a stretch, whose mean is looked at
constexpr std::size_t kPlacesOfRing = 8;  // of a small ring, all round
constexpr double kBesideWidths = 1.25;    // of the stroke: there the skin beside it is looked at

/// Where one place of a stroke falls as the projector's picture is shifted, and its pixels in one camera.
struct ShiftedPlace {
    std::array<Vector3d, kStencil> p_in_ct;
    std::array<std::array<Vector2d, kStencil>, 2> pixel;
    std::array<Vector2d, 2> aside_px;  ///< to the skin beside the stroke
};

class Shifts {
public:
    Shifts(const SkinSurface& skin, const RigCalibration& rig, const RigidTransform& rig_from_ct, double reach_mm)
        : skin_(skin), rig_(rig), rig_from_ct_(rig_from_ct), ct_from_rig_(rig_from_ct.inverse()), reach_mm_(reach_mm) {}

    /// Pixels of the projector that a reach is, at the depth of the middle of all.
    void at_depth_of(const std::vector<SightedSegment>& segments) {
        std::vector<double> depths_mm;
        for (const SightedSegment& s : segments)
            depths_mm.push_back((rig_.projector.device_from_rig * (rig_from_ct_ * s.segment->middle().p_in_ct)).z());
        reach_px_ = rig_.projector.focal_x * reach_mm_ / median(std::move(depths_mm));
    }

    std::optional<ShiftedPlace> follow(const StrokePlace& place) const {
        const auto lit = project(rig_.projector, rig_from_ct_ * place.p_in_ct);
        if (!lit) return std::nullopt;
        ShiftedPlace shifted;
        for (std::size_t k = 0; k < kStencil; ++k) {
            const Vector2d shift(static_cast<double>(k % 3) - 1, static_cast<double>(k / 3) - 1);
            const auto p = lit_by(*lit + reach_px_ * shift, place);
            if (!p) return std::nullopt;
            shifted.p_in_ct[k] = *p;
            for (std::size_t c = 0; c < 2; ++c) {
                const auto pixel = project(camera(c), rig_from_ct_ * *p);
                if (!pixel) return std::nullopt;
                shifted.pixel[c][k] = *pixel;
            }
        }
        const Vector3d beside = place.p_in_ct + kBesideWidths * place.width_mm * place.sideways_in_ct;
        for (std::size_t c = 0; c < 2; ++c) {
            const auto pixel = project(camera(c), rig_from_ct_ * beside);
            if (!pixel) return std::nullopt;
            shifted.aside_px[c] = *pixel - shifted.pixel[c][kStencil / 2];
        }
        return shifted;
    }

private:
    const CameraModel& camera(std::size_t c) const { return c == 0 ? rig_.left_camera : rig_.right_camera; }

    /// The skin that a pixel of the projector lights; beside the head's edge, the plane of the place.
    std::optional<Vector3d> lit_by(const Vector2d& pixel, const StrokePlace& place) const {
        const auto ray = ray_through(rig_.projector, pixel);
        if (!ray) return std::nullopt;
        const Vector3d origin = ct_from_rig_ * ray->origin, way = ct_from_rig_.linear() * ray->direction;
        const auto hit = skin_.first_hit({origin, way});
        if (hit && (hit->p_in_ct - place.p_in_ct).norm() < 3 * reach_mm_) return hit->p_in_ct;
        const double towards = way.dot(place.normal_in_ct);
        if (std::abs(towards) < 0.1) return std::nullopt;
        return Vector3d(origin + way * ((place.p_in_ct - origin).dot(place.normal_in_ct) / towards));
    }

    const SkinSurface& skin_;
    const RigCalibration& rig_;
    const RigidTransform& rig_from_ct_;
    const RigidTransform ct_from_rig_;
    double reach_mm_, reach_px_ = 0;
};

/// A stretch: how far it lies aside at each shift, and how clearly each camera sees its light there.
struct Stretch {
    std::vector<ShiftedPlace> places;
    std::array<bool, 2> seen{};
    bool one_side = false;
};

/// The shifts of one row of a disc, from left to right, in reaches.
struct ShiftRow {
    double v = 0, first_u = 0, step = 0;
    std::size_t from = 0, count = 0;  ///< among all shifts
};

/// NaN where one of them is.
double larger_of(double a, double b) {
    return (a + b + std::abs(a - b)) / 2;
}

/// The light across the stroke's direction at each shift, grey: the stroke's place less the skin to both sides of it.
/// NaN where a part of it lies outside of the picture.
void find_ridges(const Stretch& stretch, std::size_t camera, const GrayImage& picture,
                 const std::vector<ShiftRow>& rows, std::vector<double>& greys) {
    std::fill(greys.begin(), greys.end(), 0);
    for (const ShiftedPlace& place : stretch.places) {
        const Vector2d& aside = place.aside_px[camera];
        for (const ShiftRow& row : rows) {
            // Along a row the quadratic through the stencil is one of u alone.
            const Vector2d low = biquadratic(place.pixel[camera], -1, row.v),
                           middle = biquadratic(place.pixel[camera], 0, row.v),
                           high = biquadratic(place.pixel[camera], 1, row.v);
            const Vector2d slope = (high - low) / 2, bend = (high + low) / 2 - middle;
            for (std::size_t k = 0; k < row.count; ++k) {
                const double u = row.first_u + static_cast<double>(k) * row.step;
                const double x = middle.x() + u * (slope.x() + u * bend.x()),
                             y = middle.y() + u * (slope.y() + u * bend.y());
                const double left = bilinear_or_nan(picture, x - aside.x(), y - aside.y()),
                             right = bilinear_or_nan(picture, x + aside.x(), y + aside.y());
                greys[row.from + k] +=
                    bilinear_or_nan(picture, x, y) - (stretch.one_side ? right : larger_of(left, right));
            }
        }
    }
    for (double& grey : greys) grey /= static_cast<double>(stretch.places.size());
}

/// By shift: the share of a camera's stretches whose light stands out there, and by how much, capped.
struct Seen {
    std::size_t stretches = 0;
    std::vector<double> share, score;
};

Seen look(const std::vector<Stretch>& stretches, std::size_t camera, const GrayImage& picture,
          const std::vector<ShiftRow>& rows, const FarLightSettings& settings) {
    constexpr double kMostSigmas = 8, kLeastNoise_grey = 0.4;
    const std::size_t shifts = rows.back().from + rows.back().count;
    Seen seen;
    seen.share.assign(shifts, 0);
    seen.score.assign(shifts, 0);
    std::vector<double> greys(shifts);
    for (const Stretch& stretch : stretches) {
        if (!stretch.seen[camera]) continue;
        find_ridges(stretch, camera, picture, rows, greys);
        std::vector<double> inside;
        for (const double grey : greys)
            if (!std::isnan(grey)) inside.push_back(grey);
        if (2 * inside.size() < shifts) continue;
        ++seen.stretches;
        const double usual = median(inside);
        for (double& grey : inside) grey = std::abs(grey - usual);
        const double noise = std::max(1.4826 * median(std::move(inside)), kLeastNoise_grey);
        for (std::size_t k = 0; k < shifts; ++k) {
            if (std::isnan(greys[k])) continue;  // what no camera sees speaks for no shift
            const double sigmas = (greys[k] - usual) / noise;
            seen.score[k] += std::clamp(sigmas, 0.0, kMostSigmas);
            if (sigmas >= settings.least_sigmas && greys[k] >= settings.least_grey) seen.share[k] += 1;
        }
    }
    for (std::vector<double>* values : {&seen.share, &seen.score})
        for (double& value : *values) value /= static_cast<double>(std::max<std::size_t>(1, seen.stretches));
    return seen;
}

std::vector<Stretch> stretches_of(const std::vector<SightedSegment>& segments, const Shifts& shifts, std::size_t most) {
    std::vector<Stretch> stretches;
    const std::size_t step = std::max<std::size_t>(1, (segments.size() + most - 1) / most);
    for (std::size_t i = 0; i < segments.size(); i += step) {
        const std::vector<StrokePlace>& places = segments[i].segment->places;
        Stretch stretch{{}, segments[i].seen, segments[i].one_side};
        const std::size_t along = segments[i].one_side ? kPlacesOfRing : kPlacesAlong;
        for (std::size_t k = 0; k < along; ++k) {
            const auto place = shifts.follow(places[(2 * k + 1) * places.size() / (2 * along)]);
            if (place) stretch.places.push_back(*place);
        }
        if (stretch.places.size() == along) stretches.push_back(std::move(stretch));
    }
    return stretches;
}

/// A disc of shifts, in reaches.
std::vector<ShiftRow> disc(double step) {
    std::vector<ShiftRow> rows;
    std::size_t shifts = 0;
    const int n = static_cast<int>(1 / step);
    for (int y = -n; y <= n; ++y) {
        int half = n;
        while (half >= 0 && Vector2d(half, y).norm() * step > 1) --half;
        if (half < 0) continue;
        rows.push_back({step * y, -step * half, step, shifts, static_cast<std::size_t>(2 * half + 1)});
        shifts += rows.back().count;
    }
    return rows;
}

}  // namespace

std::optional<double> find_far_light(const std::vector<SightedSegment>& segments, const SkinSurface& skin,
                                     const RigCalibration& rig, const RigidTransform& rig_from_ct,
                                     const StereoFrame& frame, const FarLightSettings& settings) {
    if (segments.size() < settings.least_segments) return std::nullopt;
    Shifts follow(skin, rig, rig_from_ct, settings.reach_mm);
    follow.at_depth_of(segments);
    const std::vector<Stretch> stretches = stretches_of(segments, follow, settings.most_segments);
    const std::vector<ShiftRow> rows = disc(settings.step_mm / settings.reach_mm);
    const std::array<Seen, 2> seen{look(stretches, 0, frame.left, rows, settings),
                                   look(stretches, 1, frame.right, rows, settings)};
    for (const Seen& camera : seen)
        if (camera.stretches < settings.least_segments) return std::nullopt;
    std::vector<Vector2d> shifts;
    for (const ShiftRow& row : rows)
        for (std::size_t k = 0; k < row.count; ++k)
            shifts.emplace_back(row.first_u + static_cast<double>(k) * row.step, row.v);

    const auto off_mm = [&](const Vector2d& shift) {
        std::vector<double> off;
        for (const Stretch& s : stretches) {
            const auto& places = s.places[s.places.size() / 2].p_in_ct;
            off.push_back((biquadratic(places, shift.x(), shift.y()) - places[kStencil / 2]).norm());
        }
        return median(std::move(off));
    };
    // What both cameras see: the worse of the two, so that neither's own lines make a shift.
    std::vector<double> score;
    for (std::size_t k = 0; k < shifts.size(); ++k) score.push_back(std::min(seen[0].score[k], seen[1].score[k]));
    constexpr double kAsGood = 0.95;
    const double best = *std::max_element(score.begin(), score.end());
    std::size_t at = shifts.size();
    double off_at = 0;
    if (best < settings.least_score) return std::nullopt;
    for (std::size_t k = 0; k < shifts.size(); ++k) {
        if (score[k] < kAsGood * best) continue;
        const double off = off_mm(shifts[k]);
        if (at == shifts.size() || off < off_at) at = k, off_at = off;
    }
    if (off_at <= settings.near_mm || score[at] < settings.least_score) return std::nullopt;
    for (std::size_t k = 0; k < shifts.size(); ++k) {
        const bool another = settings.reach_mm * (shifts[k] - shifts[at]).norm() > settings.near_mm;
        if (another && score[k] < kAsGood * best && score[at] < settings.least_score_more * score[k])
            return std::nullopt;
    }
    for (const Seen& camera : seen)
        if (camera.share[at] < settings.least_share ||
            camera.share[at] < median(camera.share) + settings.least_share_more)
            return std::nullopt;
    return off_at;
}

}  // namespace planlight
