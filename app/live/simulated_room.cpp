#include "app/live/simulated_room.h"

#include "app/live/scene_of_session.h"
#include "app/live/simulated_fault.h"
#include "planning_io/plan/plan_file.h"

namespace planlight {

SimulatedRoom::SimulatedRoom(const Volume& volume, const Plan& plan, const simulation::RoomSettings& settings,
                             double speed_mm_s, std::string fault)
    : rig_(volume, points_of(plan), settings), speed_mm_s_(speed_mm_s), fault_(std::move(fault)) {}

void SimulatedRoom::begin_fault() {
    planlight::begin_fault(fault_, rig_);
}

void SimulatedRoom::let_patient_move(bool moves) {
    if (moves != moving_) rig_.set_motion({moves ? speed_mm_s_ : 0, rig_.clock().now()});
    moving_ = moves;
}

std::shared_ptr<const std::vector<LightLine>> SimulatedRoom::true_light(const PlanDrawing& drawing,
                                                                        const OverlayStep& overlay) const {
    return true_light_lines(drawing, rig_.calibration(), overlay, rig_);
}

}  // namespace planlight
