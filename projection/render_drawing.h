#pragma once

#include <memory>
#include <vector>

#include "planning_io/types/rig_calibration.h"
#include "projection/draw_plan.h"

namespace planlight {

struct RenderSettings {
    double steepest = 1.31;               ///< radians (75 degrees) between skin normal and light: beyond it nothing is drawn
    double brightness = 1;
    double halo_mm = 1.2;                 ///< darkness kept round the markers' stickers
    std::vector<Eigen::Vector3d> keep_dark_in_patient;  ///< marker centres that no light may touch
    double keep_dark_radius_mm = 9;
    int only_item = -1;                   ///< draw one item alone (for measuring); -1 draws all
};

/// Renders drawings for the projector's view: true occlusion by the skin, lens distortion, anti-aliased strokes.
/// Holds the depth mesh, so that a picture a frame costs only the strokes.
class DrawingRenderer {
public:
    DrawingRenderer(const SkinSurface& skin, const CameraModel& projector);
    ~DrawingRenderer();

    /// The projector picture for a head at `rig_from_ct` (T_global).
    RgbImage render(const PlanDrawing& drawing, const RigidTransform& rig_from_ct,
                    const RigidTransform& rig_from_patient = RigidTransform::Identity(),
                    const RenderSettings& settings = {}) const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace planlight
