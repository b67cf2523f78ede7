#include "app/windows/operator_model.h"

namespace planlight {

bool SceneModel::operator==(const SceneModel& o) const {
    return skin == o.skin && on_paper == o.on_paper && of_scan == o.of_scan && cloud == o.cloud &&
           cloud_distance_mm == o.cloud_distance_mm && ct_from_rig.matrix() == o.ct_from_rig.matrix() &&
           markers == o.markers && plan == o.plan && light == o.light && risk_structures == o.risk_structures &&
           skin_offset_mm == o.skin_offset_mm && largest_distance_mm == o.largest_distance_mm &&
           skin_error_mm == o.skin_error_mm && bright_item == o.bright_item && warn_above_mm == o.warn_above_mm &&
           stop_above_mm == o.stop_above_mm;
}

bool FitViews::operator==(const FitViews& o) const {
    return before_ct_from_rig.matrix() == o.before_ct_from_rig.matrix() && before_distance_mm == o.before_distance_mm &&
           predicted_mm == o.predicted_mm;
}

SceneModel scene_of_fit(const OperatorModel& model, FitView view) {
    SceneModel scene = model.scene;
    scene.warn_above_mm = model.warn_above_mm;
    scene.stop_above_mm = model.stop_above_mm;
    if (model.look_at && view == FitView::after) {  // the ring stands out on bare skin, not on a scan of its own colour
        scene.cloud = nullptr;
        scene.cloud_distance_mm = nullptr;
    }
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
