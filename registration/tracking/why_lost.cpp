#include "registration/tracking/why_lost.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace planlight {
namespace {

StereoFrame exchanged(StereoFrame frame) {
    std::swap(frame.left, frame.right);
    return frame;
}

StereoFrame turned_half(StereoFrame frame) {
    for (GrayImage* picture : {&frame.left, &frame.right}) std::ranges::reverse(picture->pixels);
    return frame;
}

StereoFrame mirrored(StereoFrame frame) {
    for (GrayImage* picture : {&frame.left, &frame.right})
        for (int y = 0; y < picture->height; ++y)
            std::reverse(picture->pixels.begin() + y * picture->width,
                         picture->pixels.begin() + (y + 1) * picture->width);
    return frame;
}

/// By how much the patient would have turned since the reference, radians; empty without a pose by both cameras.
std::optional<double> turn_in(PatientTracker tracker, const StereoFrame& frame) {
    const TrackedPose pose = tracker.update(frame);
    if (!pose.rig_from_patient || pose.markers_left < 3 || pose.markers_right < 3) return std::nullopt;
    return angle_between(*pose.rig_from_patient, RigidTransform::Identity());
}

/// Of pictures put right in several ways. Two cameras side by side see a room that is turned by half as they would see
/// it exchanged: of ways that both give a pose, the one with the lesser turn of the patient is it.
std::optional<WhyLost::Cause> put_right(const PatientTracker& tracker, const StereoFrame& frame) {
    using Cause = WhyLost::Cause;
    std::optional<Cause> cause;
    double least = 10;
    const auto look = [&](Cause by, const StereoFrame& changed) {
        if (const auto turn = turn_in(tracker, changed); turn && *turn < least) least = *turn, cause = by;
    };
    look(Cause::turned, turned_half(frame));
    look(Cause::mirrored, mirrored(frame));
    const bool same_size = frame.left.width == frame.right.width && frame.left.height == frame.right.height;
    if (same_size) look(Cause::exchanged, exchanged(frame));
    return cause;
}

}  // namespace

WhyLost why_lost(const PatientTracker& tracker, const StereoFrame& frame) {
    using Cause = WhyLost::Cause;
    PatientTracker anew = tracker;
    const std::size_t meet = anew.set_reference(frame).size(), wanted = tracker.markers().size();
    WhyLost why{Cause::fewer_seen, anew.seen_left().size(), anew.seen_right().size()};
    if (const auto cause = put_right(tracker, frame))
        why.cause = *cause;
    else if (std::min(why.left, why.right) >= wanted)
        why.cause = meet >= wanted ? Cause::rearranged : Cause::camera_moved;
    return why;
}

}  // namespace planlight
