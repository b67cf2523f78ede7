#pragma once

#include <memory>
#include <optional>
#include <string>

#include "planning_io/types/registration_result.h"
#include "planning_io/types/tracked_pose.h"
#include "projection/render_drawing.h"
#include "registration/devices/projector.h"
#include "registration/tracking/predict_pose.h"

namespace planlight {

/// From when on a pose is too old, too unsure or too far to be drawn with.
struct OverlaySettings {
    Instant max_pose_age = std::chrono::milliseconds(75);  ///< an older pose is not drawn
    Instant picture_validity = std::chrono::milliseconds(75);
    /// From the beginning of a step (not from the moment of its pose) to light, for the prediction, until the
    /// projector's own promises of the last pictures tell it.
    Instant light_delay = std::chrono::milliseconds(25);
    double max_predicted_error_mm = 1.0;  ///< one sigma where the pose counts; above: dark
    bool predict = true;
    PredictionSettings prediction;
    /// Light that comes later than `prediction.max_ahead` after its pose is dark where the head gets farther than this
    /// in the time that is left over.
    double most_unpredicted_mm = 0.5;
    /// The picture is drawn for the middle of the time that it will be light, as the last pictures tell it: until the
    /// next one comes. At most so far past its beginning; 0: for its beginning.
    Instant most_ahead = std::chrono::milliseconds(30);
    bool operator_confirmed = false;  ///< a person has looked at the overlay on landmarks: a verdict `ask` is drawn
    RenderSettings render;
};

/// `OverlayStep::reason` where the head lies so that the projector reaches no part of what is to be lit.
inline constexpr const char* kNothingInTheLight = "nothing of the plan lies in the projector's light";

/// What the overlay did with one pose.
struct OverlayStep {
    bool lit = false;
    std::string reason;  ///< why it is dark, in words; empty when lit
    RgbImage picture;    ///< what was shown (black when dark)
    RenderCounts counts;
    Instant lit_from{};                                       ///< when it is light on the skin
    RigidTransform rig_from_ct = RigidTransform::Identity();  ///< T_global it was drawn for
};

/// DRAW: T_global = T_cur T_ini -> bitmap -> projector, or darkness. Nothing is drawn without a fresh, good pose.
///
/// Keeps references to projector, clock, renderer and drawing; copies the rest.
class OverlayLoop {
public:
    OverlayLoop(Projector& projector, const Clock& clock, const DrawingRenderer& renderer, const PlanDrawing& drawing,
                const RegistrationResult& registration, const OverlaySettings& settings = {});
    ~OverlayLoop();  ///< dark

    /// One pose, one picture or darkness. Whatever is thrown on the way, the projector is dark before it leaves.
    OverlayStep step(const TrackedPose& pose);

    /// The operator's word on the overlay (`OverlaySettings::operator_confirmed`) while the loop runs.
    void set_operator_confirmed(bool confirmed);

    /// Light was found to come so much later than the projector promises; negative: earlier.
    void set_found_delay(Instant later);

    /// Share of the projector's light from the next step on (`RenderSettings::brightness`).
    void set_brightness(double share);

    /// From the beginning of a step to light, as the last pictures tell it, with what was found.
    Instant light_delay() const;

    /// How much later the last light could have come and still be drawn ahead; negative: it came later than that.
    Instant spare_time() const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace planlight
