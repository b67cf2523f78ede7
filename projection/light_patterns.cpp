#include "projection/light_patterns.h"

#include <cmath>

#include "projection/light_depth.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

/// The picture that is light at that moment when all come `delay_s` later than told; null: none of those known.
const ShownPicture* lit_at(const std::vector<ShownPicture>& shown, Instant at, double delay_s) {
    const ShownPicture* lit = nullptr;
    for (const ShownPicture& picture : shown)
        if (picture.lit_from + from_seconds(delay_s) <= at) lit = &picture;
    return lit;
}

/// How the light of a place goes along `sideways` per radian of the projector turned about its right, down and forward.
Vector3d turned_projector(const SeenSegment& segment, const RigidTransform& rig_from_ct, const CameraModel& projector) {
    const RigidTransform device_from_ct = projector.device_from_rig * rig_from_ct;
    const Vector3d p = device_from_ct * segment.p_in_ct;  // the device is at the origin
    const Vector3d n = device_from_ct.linear() * segment.normal_in_ct;
    const Vector3d s = device_from_ct.linear() * segment.sideways_in_ct;
    const double towards = p.dot(n);
    Vector3d by;
    for (int axis = 0; axis < 3; ++axis) {
        const Vector3d turned = Vector3d::Unit(axis).cross(p);
        by[axis] = s.dot(turned - turned.dot(n) / towards * p);
    }
    return by;
}

/// Light that both cameras see at other places lies above or below the skin: how far along the normal, positive
/// outwards. Empty where they look too much alike.
std::optional<double> depth_mm(const SeenSegment& segment, const RigidTransform& rig_from_ct,
                               const RigCalibration& rig) {
    constexpr double kLeastParallax = 0.15;
    if (!segment.by_camera_mm[0] || !segment.by_camera_mm[1]) return std::nullopt;
    const RigidTransform ct_from_rig = rig_from_ct.inverse();
    const double apart = sideways_slope(segment, ct_from_rig * rig.right_camera.centre_in_rig()) -
                         sideways_slope(segment, ct_from_rig * rig.left_camera.centre_in_rig());
    if (std::abs(apart) < kLeastParallax) return std::nullopt;
    return (*segment.by_camera_mm[0] - *segment.by_camera_mm[1]) / apart;
}

}  // namespace

double aside_mm(const SeenSegment& segment, const RigidTransform& drawn, const RigidTransform& now,
                const CameraModel& projector) {
    const RigidTransform ct_from_rig = now.inverse();
    const Vector3d eye = ct_from_rig * projector.centre_in_rig();
    const Vector3d way = ct_from_rig * (drawn * segment.p_in_ct) - eye;
    const double along = way.dot(segment.normal_in_ct);
    if (std::abs(along) < 1e-9) return 0;
    const Vector3d lit = eye + way * ((segment.p_in_ct - eye).dot(segment.normal_in_ct) / along);
    return (lit - segment.p_in_ct).dot(segment.sideways_in_ct);
}

std::vector<LightSample> light_samples(const std::vector<LightFacts>& facts, Instant from, const RigCalibration& rig,
                                       const std::vector<double>& delays_s) {
    constexpr double kCommon_mm = 0.1;
    std::vector<LightSample> samples;
    for (const LightFacts& frame : facts) {
        if (frame.at < from || !frame.pose) continue;
        const ShownPicture* told = lit_at(frame.shown, frame.at, 0);
        for (const SeenSegment& segment : frame.segments) {
            if (!segment.seen) continue;
            LightSample sample;
            sample.at = frame.at;
            sample.off_mm = segment.off_mm - segment.by_depth_mm;
            sample.weight = 1 / (std::pow(segment.sigma_mm, 2) + kCommon_mm * kCommon_mm);
            if (told) sample.told_mm = aside_mm(segment, told->rig_from_ct, frame.rig_from_ct, rig.projector);
            sample.by_projector = turned_projector(segment, frame.rig_from_ct, rig.projector);
            const ShownPicture* before = nullptr;
            for (const double delay_s : delays_s) {
                const ShownPicture* lit = lit_at(frame.shown, frame.at, delay_s);
                const bool same = lit == before && !sample.by_delay_mm.empty();
                sample.by_delay_mm.push_back(same ? sample.by_delay_mm.back()
                                             : lit
                                                 ? aside_mm(segment, lit->rig_from_ct, frame.rig_from_ct, rig.projector)
                                                 : sample.told_mm);
                before = lit;
            }
            sample.depth_mm = depth_mm(segment, frame.rig_from_ct, rig);
            samples.push_back(std::move(sample));
        }
    }
    return samples;
}

}  // namespace planlight
