#include "registration/tracking/exchanged_cameras.h"

#include <utility>

namespace planlight {

bool cameras_seem_exchanged(const PatientTracker& tracker, const StereoFrame& frame) {
    if (frame.left.width != frame.right.width || frame.left.height != frame.right.height) return false;
    PatientTracker other = tracker;
    StereoFrame exchanged = frame;
    std::swap(exchanged.left, exchanged.right);
    const TrackedPose pose = other.update(exchanged);
    return pose.rig_from_patient && pose.markers_left >= 3 && pose.markers_right >= 3;
}

}  // namespace planlight
