#pragma once

#include <functional>
#include <memory>
#include <string>

#include "planning_io/types/steady_clock.h"
#include "registration/simulation/serve/served_camera.h"
#include "registration/simulation/simulated_rig.h"

namespace planlight::simulation {

/// How the simulated room is served as hardware.
struct ServeSettings {
    ServedCameraSettings left, right;                 ///< size, exposure and rate are those of the room
    Instant latency = std::chrono::milliseconds(32);  ///< from the end of an exposure to its sending
    double slower = 1;  ///< the cameras' rate is that of the room divided by this, for a machine that cannot keep up
};

/// The devices of a simulated room and its time. What they refer to must outlive whoever serves them.
struct ServedDevices {
    Projector& projector;
    StereoCamera& cameras;
    const Clock& clock;
    std::function<void(Instant)> wait;  ///< lets the room's time pass
};

/// What stands on the projector's monitor now, in the projector's own size. Called often, from a thread of its own.
using LookAtMonitor = std::function<RgbImage()>;

/// The simulated room as two GigE Vision cameras on the network and a projector whose light is what stands on a
/// monitor, in wall time: whoever opens the cameras and lights the monitor cannot tell it from hardware.
class ServedRoom {
public:
    /// `rig` must outlive it. Throws DeviceError when a camera's address cannot be used.
    ServedRoom(SimulatedRig& rig, LookAtMonitor look, const ServeSettings& settings);
    ServedRoom(const ServedDevices& devices, LookAtMonitor look, const ServeSettings& settings);
    ~ServedRoom();

    ServedCamera& left();
    ServedCamera& right();
    /// The cameras change places: each sends what the other sees.
    void exchange_cameras(bool exchanged);
    /// The right camera sends each picture so many frames late, with the time at which it was exposed.
    void hold_right_back(int frames);
    /// When the room's clock was 0, on the wall's (`SteadyClock`): the room's own time is what has passed since.
    Instant room_began() const;
    /// Pictures that were made since the beginning, and those that came too late for their own moment.
    std::uint64_t made() const;
    std::uint64_t late() const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace planlight::simulation
