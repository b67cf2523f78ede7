#pragma once

#include <string>
#include <vector>

#include "app/live/room.h"
#include "app/live/room_cameras.h"
#include "planning_io/case/room_file.h"
#include "planning_io/types/steady_clock.h"

namespace planlight {

/// A room of real devices in wall time: two GenICam cameras and the projector that the caller keeps.
class RealRoom final : public Room {
public:
    /// Opens the cameras. Throws DeviceError when one does not answer or does not take its settings, CheckFailedError
    /// when they or the projector are not those of the rig file: another resolution, other serials, left and right
    /// exchanged.
    RealRoom(const RoomFile& room, const RigCalibration& rig, Projector& projector, const RoomProgress& progress = {});

    std::string name() const override { return room_.name.empty() ? "the room" : room_.name; }
    const RigCalibration& rig() const override { return rig_; }
    Projector& projector() override { return projector_; }
    StereoCamera& cameras() override { return cameras_.pair(); }
    const Clock& clock() const override { return clock_; }
    MarkerDesign markers() const override { return {room_.disc_mm, room_.sticker_mm}; }
    std::vector<std::string> notes() const override { return cameras_.notes(); }

private:
    RoomFile room_;
    RigCalibration rig_;
    Projector& projector_;
    SteadyClock clock_;
    RoomCameras cameras_;
};

}  // namespace planlight
