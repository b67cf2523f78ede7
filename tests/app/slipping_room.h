#pragma once

#include "app/live/room.h"
#include "planning_io/plan/plan_file.h"
#include "registration/simulation/simulated_rig.h"
#include "tests/app/played_session.h"

namespace planlight::test {

/// The simulated room with stickers that all slip along the skin by 2.5 mm when they are told to, or
/// (`after_good_light`) once the light was green for some updates: as far as they can so that they still agree with
/// each other, and farther than light may lie beside the plan.
class SlippingRoom final : public Room {
public:
    explicit SlippingRoom(const simulation::RoomSettings& settings, bool after_good_light = false)
        : rig_(example_case().volume, points_of(example_case().prepared.plan), settings),
          after_good_light_(after_good_light) {}
    std::string name() const override { return "a room whose markers slip"; }
    const RigCalibration& rig() const override { return rig_.calibration(); }
    Projector& projector() override { return rig_.projector(); }
    StereoCamera& cameras() override { return rig_.cameras(); }
    const Clock& clock() const override { return rig_.clock(); }
    RoomKind kind() const override { return RoomKind::simulated; }
    void computing() override { rig_.wait(std::chrono::milliseconds(10)); }
    void begin_fault() override {
        if (after_good_light_) slip();
    }
    void slip() { rig_.slip_marker(-1, {1.0, -1.0, 2.05}); }

private:
    simulation::SimulatedRig rig_;
    bool after_good_light_;
};

}  // namespace planlight::test
