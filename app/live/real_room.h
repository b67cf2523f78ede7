#pragma once

#include <string>
#include <vector>

#include "app/live/room.h"
#include "planning_io/case/room_file.h"
#include "planning_io/types/steady_clock.h"
#include "registration/devices/genicam_camera.h"
#include "registration/devices/paired_cameras.h"

namespace planlight {

/// How a camera of room.json is opened.
GenicamSettings genicam_settings(const RoomCamera& camera, const std::string& name);

/// A room of real devices in wall time: two GenICam cameras and the projector that the caller keeps.
class RealRoom final : public Room {
public:
    /// Opens the cameras. Throws DeviceError when one does not answer or does not take its settings, CheckFailedError
    /// when they or the projector are not those of the rig file: another resolution, other serials, left and right
    /// exchanged.
    RealRoom(const RoomFile& room, const RigCalibration& rig, Projector& projector);

    std::string name() const override { return room_.name.empty() ? "the room" : room_.name; }
    const RigCalibration& rig() const override { return rig_; }
    Projector& projector() override { return projector_; }
    StereoCamera& cameras() override { return *cameras_; }
    const Clock& clock() const override { return clock_; }
    std::vector<std::string> notes() const override;

private:
    RoomFile room_;
    RigCalibration rig_;
    Projector& projector_;
    SteadyClock clock_;
    FrameBell bell_;
    GenicamCamera *left_ = nullptr, *right_ = nullptr;  ///< of `cameras_`
    std::unique_ptr<PairedCameras> cameras_;
};

}  // namespace planlight
