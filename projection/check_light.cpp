#include "projection/check_light.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "planning_io/types/statistics.h"
#include "projection/find_light.h"
#include "projection/stroke_places.h"

namespace planlight {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// What both cameras say of a segment: the mean by weight where they agree; the nearer one where they do not (one of
/// them took something else for the light).
SeenSegment joined(const StrokeSegment& segment, const std::array<CameraLook, 2>& looks,
                   const CheckLightSettings& settings) {
    SeenSegment result{segment.item, segment.middle().p_in_ct, segment.middle().sideways_in_ct};
    double weight = 0, sum = 0;
    for (std::size_t c = 0; c < 2; ++c) {
        if (!looks[c].light) continue;
        result.by_camera[c] = result.seen = true;
        const double w = 1 / (std::pow(looks[c].light->sigma_mm, 2) + std::pow(settings.place_sigma_mm, 2));
        weight += w;
        sum += w * looks[c].light->off_mm;
    }
    if (!result.seen) return result;
    result.off_mm = sum / weight;
    result.sigma_mm = 1 / std::sqrt(weight);
    if (result.by_camera[0] && result.by_camera[1]) {
        const double apart = std::abs(looks[0].light->off_mm - looks[1].light->off_mm);
        const double a = std::abs(looks[0].light->off_mm), b = std::abs(looks[1].light->off_mm);
        if (apart > 1) result.off_mm = looks[a < b ? 0 : 1].light->off_mm;
        result.sigma_mm = std::hypot(result.sigma_mm, apart / 2);
    }
    return result;
}

/// The shift along the skin that explains an item's segments best: least squares over their sides, with Huber weights.
void find_shift(const std::vector<const SeenSegment*>& seen, ItemLight& item) {
    constexpr int kRounds = 5;
    constexpr double kHuber = 1.5, kToldShare = 0.1;
    Vector3d shift = Vector3d::Zero();
    Matrix3d information = Matrix3d::Zero(), inverse = Matrix3d::Zero();
    for (int round = 0; round < kRounds; ++round) {
        information.setZero();
        Vector3d right = Vector3d::Zero();
        for (const SeenSegment* s : seen) {
            const double off = (s->off_mm - s->sideways_in_ct.dot(shift)) / s->sigma_mm;
            const double w =
                (round == 0 || std::abs(off) < kHuber ? 1 : kHuber / std::abs(off)) / std::pow(s->sigma_mm, 2);
            information += w * s->sideways_in_ct * s->sideways_in_ct.transpose();
            right += w * s->off_mm * s->sideways_in_ct;
        }
        // Only in the directions that the sides tell: a straight line tells one, a circle two.
        const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(information);
        inverse.setZero();
        int told = 0;
        for (int k = 0; k < 3; ++k) {
            if (axes.eigenvalues()[k] < kToldShare * axes.eigenvalues()[2]) continue;
            inverse += axes.eigenvectors().col(k) * axes.eigenvectors().col(k).transpose() / axes.eigenvalues()[k];
            ++told;
        }
        item.one_direction_only = told < 2;
        shift = inverse * right;
    }
    item.shift_in_ct = shift;
    item.off_mm = shift.norm();
    const Vector3d way = item.off_mm > 1e-6 ? Vector3d(shift / item.off_mm) : seen.front()->sideways_in_ct;
    item.sigma_mm = std::sqrt(way.dot(inverse * way));
}

void sum_up(LightCheck& check) {
    std::vector<double> sizes, sigmas;
    for (const SeenSegment& s : check.segments) {
        if (!s.seen) continue;
        sizes.push_back(std::abs(s.off_mm));
        sigmas.push_back(s.sigma_mm);
    }
    check.expected = static_cast<int>(check.segments.size());
    check.seen = static_cast<int>(sizes.size());
    check.off_mm = quantile(sizes, 0.95);
    check.median_mm = median(std::move(sizes));
    check.sigma_mm = median(std::move(sigmas));
}

}  // namespace

LightCheck check_light(const PlanDrawing& drawing, const SkinSurface& skin, const RigCalibration& rig,
                       const RigidTransform& rig_from_ct, const StereoFrame& frame,
                       const CheckLightSettings& settings) {
    LightCheck check;
    check.items.resize(drawing.items.size());
    for (const StrokeSegment& segment : segments_to_look_at(drawing, skin, rig.projector, rig_from_ct, settings)) {
        const std::array looks{find_light(segment, skin, rig.left_camera, rig_from_ct, frame.left, settings),
                               find_light(segment, skin, rig.right_camera, rig_from_ct, frame.right, settings)};
        if (!looks[0].asked && !looks[1].asked) continue;
        check.segments.push_back(joined(segment, looks, settings));
    }
    for (std::size_t i = 0; i < check.items.size(); ++i) {
        std::vector<const SeenSegment*> seen;
        for (const SeenSegment& s : check.segments) {
            if (s.item != static_cast<int>(i)) continue;
            ++check.items[i].segments;
            if (s.seen) seen.push_back(&s);
        }
        check.items[i].seen = static_cast<int>(seen.size());
        if (!seen.empty()) find_shift(seen, check.items[i]);
    }
    sum_up(check);
    return check;
}

}  // namespace planlight
