#pragma once

#include <atomic>

#include "registration/simulation/simulated_rig.h"

namespace planlight::simulation {

/// The projector of a room whose head begins to move when the plan is lit, and lies still when stripes come.
///
/// A served room is told nothing by the program that it is served to: what stands on its monitor is all it has to go
/// by. Light on less than a tenth of the picture is that of a plan: from then on the head moves, also in the dark.
/// Light on more is that of a scan or a flash: the head lies still, and stays so until a plan is lit again.
class HeadUnderLight : public Projector {
public:
    /// `rig` must outlive it. `speed_mm_s`: the greatest speed of the head's middle; 0: it lies still.
    HeadUnderLight(SimulatedRig& rig, double speed_mm_s) : rig_(rig), speed_mm_s_(speed_mm_s) {}

    /// From the next picture on. May be called from any thread.
    void set_speed(double speed_mm_s) { speed_mm_s_ = speed_mm_s; }

    int width() const override { return rig_.projector().width(); }
    int height() const override { return rig_.projector().height(); }
    Instant show(const RgbImage& picture, Instant valid_until) override;
    void go_dark() noexcept override { rig_.projector().go_dark(); }

private:
    SimulatedRig& rig_;
    std::atomic<double> speed_mm_s_;
    double moves_at_mm_s_ = 0;
};

/// Share of the pixels that are lit.
double lit_share(const RgbImage& picture);

}  // namespace planlight::simulation
