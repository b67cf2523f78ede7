#pragma once

#include <string>
#include <vector>

#include "app/live/room.h"
#include "app/live/room_cameras.h"
#include "planning_io/case/room_file.h"
#include "planning_io/types/steady_clock.h"

namespace planlight {

/// Throws CheckFailedError when cameras or projector are not those of the rig file: another resolution, other serials,
/// left and right exchanged. What one of the two does not say is not compared.
void check_devices(const RoomCameras& cameras, const Projector& projector, const RigCalibration& rig);

/// A room of real devices in wall time, or of their recording: two cameras and the projector that the caller keeps.
class RealRoom final : public Room {
public:
    /// Opens the cameras. `projector`: null in a recorded room without a monitor. Throws DeviceError when a device does
    /// not answer or does not take its settings, and what `check_devices` throws.
    RealRoom(const RoomFile& room, const RigCalibration& rig, Projector* projector, const RoomProgress& progress = {});

    std::string name() const override { return room_.name.empty() ? "the room" : room_.name; }
    const RigCalibration& rig() const override { return rig_; }
    Projector& projector() override { return recorded_projector_ ? *recorded_projector_ : *projector_; }
    StereoCamera& cameras() override { return cameras_.pair(); }
    const Clock& clock() const override { return clock_; }
    MarkerDesign markers() const override { return {room_.disc_mm, room_.sticker_mm}; }
    std::vector<std::string> notes() const override { return cameras_.notes(); }
    RoomKind kind() const override { return cameras_.recorded() ? RoomKind::recorded : RoomKind::real; }

private:
    RoomFile room_;
    RigCalibration rig_;
    Projector* projector_;  ///< null: no monitor
    SteadyClock clock_;
    RoomCameras cameras_;
    std::unique_ptr<Projector> recorded_projector_;  ///< null: real cameras see the light
};

}  // namespace planlight
