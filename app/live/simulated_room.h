#pragma once

#include "app/live/room.h"
#include "planning_io/types/volume.h"
#include "registration/simulation/simulated_rig.h"

namespace planlight {

/// The simulated operating room. Its time runs as fast as it can be computed, not as fast as the wall clock.
class SimulatedRoom final : public Room {
public:
    /// `plan`: what the markers are pasted clear of. The patient moves at `speed_mm_s` at most when asked to. `fault`:
    /// one of `simulated_faults`, or none.
    SimulatedRoom(const Volume& volume, const Plan& plan, const simulation::RoomSettings& settings, double speed_mm_s,
                  std::string fault = {});

    std::string name() const override { return "the simulated room"; }
    const RigCalibration& rig() const override { return rig_.calibration(); }
    Projector& projector() override { return rig_.projector(); }
    StereoCamera& cameras() override { return rig_.cameras(); }
    const Clock& clock() const override { return rig_.clock(); }
    RoomKind kind() const override { return RoomKind::simulated; }
    /// Each is computed, and nothing in it moves by itself.
    Instant look_interval() const override { return std::chrono::seconds(2); }
    void computing() override { rig_.wait(std::chrono::milliseconds(10)); }
    void resting(Instant duration) override { rig_.wait(duration); }
    void let_patient_move(bool moves) override;
    void begin_fault() override;
    std::shared_ptr<const std::vector<LightLine>> true_light(const PlanDrawing& drawing,
                                                             const OverlayStep& overlay) const override;

private:
    simulation::SimulatedRig rig_;
    double speed_mm_s_;
    std::string fault_;
    bool moving_ = false;
};

}  // namespace planlight
