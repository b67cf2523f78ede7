#pragma once

#include "registration/tracking/track_patient.h"

namespace planlight {

/// For a frame in which `tracker` found no pose: whether it finds one when the pictures of left and right are
/// exchanged, by markers in both. The tracker's own markers are looked for; it stays as it is. Takes as long as an
/// update that searches both pictures whole.
bool cameras_seem_exchanged(const PatientTracker& tracker, const StereoFrame& frame);

}  // namespace planlight
