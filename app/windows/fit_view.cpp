#include "app/windows/operator_model.h"

namespace planlight {

SceneModel scene_of_fit(const OperatorModel& model, FitView view) {
    SceneModel scene = model.scene;
    scene.warn_above_mm = model.warn_above_mm;
    scene.stop_above_mm = model.stop_above_mm;
    if (!model.fit || view == FitView::after) return scene;
    scene.light = nullptr;  // it falls by the pose after the fine match
    if (view == FitView::before) {
        scene.ct_from_rig = model.fit->before_ct_from_rig;
        scene.cloud_distance_mm = model.fit->before_distance_mm;
        scene.markers = nullptr;
    } else {
        scene.cloud = nullptr;
        scene.cloud_distance_mm = nullptr;
        scene.skin_error_mm = model.fit->predicted_mm;
    }
    return scene;
}

}  // namespace planlight
