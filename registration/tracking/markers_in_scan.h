#pragma once

#include "planning_io/types/rig_calibration.h"
#include "registration/scan/movement/scan_movement.h"
#include "registration/tracking/track_patient.h"

namespace planlight {

/// How far the markers moved between the pictures of a scan: they are measured in every even picture
/// (`uniform_light_frames`) by both cameras, and a pose is fitted to each. `moved_mm` is
/// without what these scatter (twice their median, 0.16 mm at most) and without what one moment alone shows. `by` is
/// `nothing` when under two moments have a pose: no markers, one camera, too few seen. Throws InputError when the
/// pictures are not of the rig's size.
ScanMovement movement_of_markers(const ScanCapture& capture, const RigCalibration& rig,
                                 const TrackingSettings& settings = {});

/// By the markers where they are measured all through the scan. Else by the skin in the pictures, unless the markers
/// moved more as far as they were seen.
ScanMovement movement_in_scan(const ScanCapture& capture, const RigCalibration& rig, const PointCloud& cloud,
                              const TrackingSettings& settings = {});

}  // namespace planlight
