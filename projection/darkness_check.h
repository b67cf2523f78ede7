#pragma once

#include <optional>

#include "planning_io/types/rig_calibration.h"
#include "planning_io/types/stereo_frame.h"
#include "projection/check_light.h"
#include "projection/draw_plan.h"
#include "projection/skin_surface.h"

namespace planlight {

struct DarknessSettings {
    double least_seen_share = 0.5;  ///< of the stretches that the cameras should see if their light were there
    int least_seen = 5;             ///< stretches
    int least_of_small = 2;         ///< of what has fewer: all of them, no farther than this beside their place
    double small_off_mm = 1;
    int lit_after = 2;            ///< looks running
    int gone_after = 4;           ///< looks running that did not see it: it went out
    double least_of_light = 0.6;  ///< of the grey that the light had; less is ink along the lines, a scar, a thread
    double moved_mm = 0.3;        ///< where the plan's skin lies so far from where it was lit, light lies elsewhere
};

/// How much brighter than the skin beside them the stretches are that were seen, grey levels, median; 0: none was.
double light_grey(const LightCheck& check);

/// The drawing's light as it falls on a head that has moved since the projector's picture was drawn for
/// `rig_from_ct_then`: each point followed from the projector to the skin where that is now. Without labels; a stroke
/// of which a part meets no skin is in pieces.
PlanDrawing light_on_moved_head(const PlanDrawing& drawing, const SkinSurface& skin, const CameraModel& projector,
                                const RigidTransform& rig_from_ct_then, const RigidTransform& rig_from_ct_now);

/// Light that was put out, and how it was.
struct LightPutOut {
    PlanDrawing drawing;
    RigidTransform rig_from_ct;                ///< where the head stood that it was lit for
    double grey = 0;                           ///< `light_grey` then; 0: not known
    std::optional<std::size_t> bright_item{};  ///< (`LightChecker`): that alone is looked for
    PlanDrawing lit_now{};  ///< what is lit in its place, and follows the head: none of it is taken for the other
};

/// Whether light that was put out is still on the skin. A projector whose picture was frozen (by its remote control),
/// or a video link that hangs, shows what it was sent last, whatever it is told.
///
/// Keeps a reference to the skin; copies the rest.
class DarknessCheck {
public:
    DarknessCheck(LightPutOut light, const SkinSurface& skin, const RigCalibration& rig,
                  const CheckLightSettings& look = {}, const DarknessSettings& settings = {});

    DarknessCheck(const DarknessCheck&) = delete;
    DarknessCheck& operator=(const DarknessCheck&) = delete;

    /// A frame in all of whose exposure the light was to be out, and where the head stands in it; empty: as it was lit.
    /// True: this look and the one before saw the light.
    bool look(const StereoFrame& frame, const std::optional<RigidTransform>& rig_from_ct = {});

    /// By the last look.
    bool lit() const { return seen_running_ >= settings_.lit_after; }
    /// So many looks could have seen it, and did not.
    bool gone() const { return unseen_running_ >= settings_.gone_after; }

private:
    void stand_at(const RigidTransform& rig_from_ct);

    LightPutOut light_;
    const SkinSurface& skin_;
    RigCalibration rig_;
    RigidTransform stands_at_;
    CheckLightSettings look_;
    DarknessSettings settings_;
    std::optional<LightChecker> checker_;
    int seen_running_ = 0, unseen_running_ = 0;
};

}  // namespace planlight
