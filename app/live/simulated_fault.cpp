#include "app/live/simulated_fault.h"

#include <numbers>

namespace planlight {

const std::vector<std::string>& simulated_faults() {
    static const std::vector<std::string> names{"projector", "left-camera", "right-camera", "marker",
                                                "markers",   "late",        "no-picture",   "frozen"};
    return names;
}

void begin_fault(const std::string& fault, simulation::SimulatedRig& rig) {
    using Device = simulation::SimulatedRig::Device;
    const Eigen::Vector3d turn = 0.08 * std::numbers::pi / 180 * Eigen::Vector3d(0.3, 1, 0).normalized();
    if (fault == "projector") rig.bump(Device::projector, turn);
    if (fault == "left-camera") rig.bump(Device::left_camera, turn);
    if (fault == "right-camera") rig.bump(Device::right_camera, turn);
    if (fault == "marker") rig.slip_marker(0, {0.6, -0.6, 1.2});
    if (fault == "markers") rig.slip_marker(-1, {1.2, -1.2, 2.5});
    if (fault == "late") rig.delay_light(std::chrono::milliseconds(90));
    if (fault == "no-picture") rig.cover_projector(true);
    if (fault == "frozen") rig.freeze_projector();
}

}  // namespace planlight
