#pragma once

#include <optional>

#include "planning_io/types/rig_calibration.h"
#include "planning_io/types/stereo_frame.h"
#include "projection/draw_plan.h"

namespace planlight::test {

/// A projector between two cameras, 700 mm before `on_ball(0.3, 0.4)`.
RigCalibration rig_before_ball();

/// What else is to be seen, and where the light truly goes.
struct LitBall {
    Eigen::Vector2d picture_moved_px{0, 0};  ///< as by a knocked projector
    std::optional<Eigen::Vector3d> covered;  ///< round this point the skin is covered by something dark, 5 mm
    double plate_mm = 0;                     ///< all of the light falls on a larger ball, so much before the skin
    double noise_grey = 1.5;
    double texture_grey = 0;  ///< of dark spots and fine lines on the skin
    std::optional<Eigen::Vector3d>
        swollen;  ///< round this point, to 10 mm, the skin is `swollen_mm` higher; to 22 less
    double swollen_mm = 0;
    double shaded_from_mm = 1e9;  ///< light falls only where the x of rig is less
    bool lit = true;
};

/// Both cameras' pictures of the ball under the drawing's light, made ray by ray: OpenCV's lens, an ideal ball. Shares
/// no code with what looks at the light.
StereoFrame pictures_of(const PlanDrawing& drawing, const RigCalibration& rig, const LitBall& settings = {});

}  // namespace planlight::test
