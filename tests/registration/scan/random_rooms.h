#pragma once

#include <string>

#include "planning_io/types/volume.h"
#include "registration/scan/scan_surface.h"
#include "registration/simulation/simulated_rig.h"

// Simulated rooms for the figures of the scan: everything that differs between rooms follows from their seed.
namespace planlight::scan_rooms {

/// A room of this seed. Beyond what the simulator draws itself (rig, pose, skin, stickers, noise, lens blur, error of
/// the calibration): the room's lamps, 5 to 35 % of full scale on skin.
simulation::RoomSettings random_room(simulation::Preset preset, unsigned seed);

constexpr double kSphereRadius_mm = 80;
/// A ball of that radius as a CT; its zero level is the sphere to 0.004 mm (voxels of 1.5 mm, values linear in the
/// distance).
Volume sphere_volume();

/// The scan of a room: its sequence ("full", "fast", "multi-frequency", or "multi-frequency-columns") shown and
/// captured, nothing decoded yet.
ScanCapture capture_of(simulation::SimulatedRig& room, const std::string& set = "full");

std::string name_of(simulation::Preset preset);

}  // namespace planlight::scan_rooms
