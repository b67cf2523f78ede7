#pragma once

#include <memory>
#include <vector>

#include "planning_io/case/room_file.h"
#include "planning_io/types/rig_calibration.h"
#include "registration/devices/recorded_camera.h"
#include "registration/devices/recorded_projector.h"

namespace planlight {

/// A recorded room as it is read from its folders: pictures of both cameras, and which of them is seen when.
struct RecordedRoom {
    std::vector<GrayImage> left, right;             ///< first those of the scan, then the frames
    std::vector<RecordedFrame> frames;              ///< what is seen while the light is none of the scan's
    DeviceSerials serials;                          ///< that the capture names
    int projector_width = 0, projector_height = 0;  ///< 0: no scan was recorded
    RecordedProjector::Which which;                 ///< by the pictures of the scan's sequence; empty without a scan

    bool has_scan() const { return projector_width > 0; }
};

/// All of it, into memory. Throws InputError or DamagedFileError for a folder that is none of its kind, that holds no
/// frame or one camera alone, or whose pictures differ in size.
RecordedRoom read_recorded_room(const RoomRecording& recording);

}  // namespace planlight
