#include "app/windows/scene_view.h"

#include <algorithm>
#include <cmath>
#include <future>

#include "app/windows/fonts.h"
#include "app/windows/headless_gl.h"
#include "app/windows/render_target.h"
#include "app/windows/scene.h"

namespace planlight {
namespace {

std::vector<RgbImage> render(const SceneModel& model, const std::vector<SceneView>& views, int width, int height) {
    const FontFiles fonts = find_fonts();
    const auto context = headless_gl(width, height);
    const auto window = render_target(width, height, 4, [] {});
    std::vector<RgbImage> pictures;
    {
        Scene scene(*window, fonts);
        for (const SceneView& view : views) {
            scene.update(model, view, width, height, std::max(0.6, height / 960.0));
            vtkObject::GlobalWarningDisplayOff();  // GLEW complains once more at the first rendering
            window->Render();
            vtkObject::GlobalWarningDisplayOn();
            pictures.push_back(picture_of(*window));
        }
    }
    window->Finalize();
    return pictures;
}

}  // namespace

std::vector<RgbImage> render_views(const SceneModel& scene, const std::vector<SceneView>& views, int width,
                                   int height) {
    // On a thread of its own: this one may have a window's context, and GLX and EGL do not share a thread.
    return std::async(std::launch::async, render, std::cref(scene), std::cref(views), width, height).get();
}

RgbImage render_scene(const SceneModel& scene, const SceneView& view, int width, int height) {
    return render_views(scene, {view}, width, height).front();
}

SceneView view_of_plan(const PlanDrawing& plan) {
    Eigen::Vector3d outward{0, -1, 0};
    for (const Stroke& stroke : plan.strokes)
        for (const Eigen::Vector3d& normal : stroke.normals_in_ct) outward += normal;
    if (outward.norm() < 1e-9) return {};
    outward = outward.normalized() + Eigen::Vector3d(0, -0.8, 0);
    outward.normalize();
    SceneView view;
    view.azimuth = std::atan2(-outward.x(), -outward.y());
    view.elevation = std::clamp(std::asin(outward.z()), -0.2, 0.8);
    return view;
}

}  // namespace planlight
