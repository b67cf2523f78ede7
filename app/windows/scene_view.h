#pragma once

#include "app/windows/operator_model.h"

namespace planlight {

/// A picture of the 3-D view with its letters and legend, made without any display (EGL), for reports and headless
/// runs.
///
/// Throws DeviceError when there is no EGL, or no font.
RgbImage render_scene(const SceneModel& scene, const SceneView& view, int width = 1280, int height = 960);

/// The same from several sides; the scene is built once.
std::vector<RgbImage> render_views(const SceneModel& scene, const std::vector<SceneView>& views, int width, int height);

/// The view that shows the plan from the front of the skin it lies on, turned a little towards the face.
SceneView view_of_plan(const PlanDrawing& plan);

}  // namespace planlight
