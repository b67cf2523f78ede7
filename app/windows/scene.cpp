#include "app/windows/scene.h"

#include <vtkActor.h>
#include <vtkBoundingBox.h>
#include <vtkCamera.h>
#include <vtkLightKit.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>

#include <algorithm>
#include <cmath>

#include "app/windows/orientation.h"
#include "app/windows/scene_overlay.h"
#include "app/windows/scene_shapes.h"

namespace planlight {
namespace {

constexpr double kHalfAngle = 0.15;  ///< radians, of the camera's field

/// A thing in the view. It stands `lift_mm` nearer to the viewer than it is, so that the skin under it does not hide
/// it.
struct Thing {
    vtkNew<vtkPolyDataMapper> mapper;
    vtkNew<vtkActor> actor;
    double lift_mm;

    Thing(vtkRenderer& renderer, double lift, bool lit) : lift_mm(lift) {
        actor->SetMapper(mapper);
        actor->SetVisibility(0);
        actor->GetProperty()->SetLighting(lit);
        renderer.AddActor(actor);
    }
    void show(vtkPolyData* data) {
        mapper->SetInputData(data);
        actor->SetVisibility(data != nullptr && data->GetNumberOfPoints() > 0);
    }
    /// Along the lines of sight: its place in the picture stays.
    void lift(const Eigen::Vector3d& eye, double distance_mm,
              const RigidTransform& ct_from_shape = RigidTransform::Identity()) {
        const Eigen::Affine3d nearer = Eigen::Translation3d(eye) *
                                       Eigen::UniformScaling<double>(1 - lift_mm / distance_mm) *
                                       Eigen::Translation3d(-eye);
        const Eigen::Matrix4d matrix = nearer.matrix() * ct_from_shape.matrix();
        vtkNew<vtkMatrix4x4> placed;
        for (int row = 0; row < 4; ++row)
            for (int column = 0; column < 4; ++column) placed->SetElement(row, column, matrix(row, column));
        actor->SetUserMatrix(placed);
    }
};

template <typename T>
bool replace(T& old, const T& now) {
    if (old == now) return false;
    old = now;
    return true;
}

}  // namespace

struct Scene::Parts {
    vtkRenderWindow& window;
    vtkNew<vtkRenderer> renderer;
    /// Over the skin what lies within, over both what is looked at on the skin: its colours stay as they are.
    vtkNew<vtkRenderer> within, upon;
    vtkNew<vtkLightKit> lights;
    Thing skin{*renderer, 0, true}, risks{*within, 0, true}, cloud{*upon, 0.9, false}, markers{*upon, 3.5, false},
        plan{*upon, 4.0, false}, light{*upon, 4.6, false};
    SceneOverlay overlay;
    SceneModel shown;
    SceneView shown_view;
    LetterInsets insets;
    int width = 0, height = 0;
    double scale = 1;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    double reach_mm = 120;  ///< half the picture's smaller side at zoom 1

    Parts(vtkRenderWindow& w, const FontFiles& fonts) : window(w), overlay(*upon, fonts) {
        window.SetNumberOfLayers(3);
        for (vtkRenderer* layer : {renderer.Get(), within.Get(), upon.Get()}) window.AddRenderer(layer);
        within->SetLayer(1);
        upon->SetLayer(2);
        for (vtkRenderer* layer : {within.Get(), upon.Get()}) {
            layer->PreserveDepthBufferOn();
            layer->AutomaticLightCreationOff();
        }
        upon->SetActiveCamera(renderer->GetActiveCamera());
        renderer->SetBackgroundAlpha(1);
        renderer->AutomaticLightCreationOff();
        lights->SetKeyLightIntensity(0.85);
        lights->SetKeyLightAngle(40, -25);
        lights->SetKeyToFillRatio(3.5);
        lights->SetKeyToHeadRatio(3.5);
        lights->SetKeyToBackRatio(5);
        for (vtkRenderer* layer : {renderer.Get(), within.Get(), upon.Get()}) lights->AddLightsToRenderer(layer);
        risks.actor->GetProperty()->SetOpacity(0.55);
        risks.actor->GetProperty()->BackfaceCullingOn();
        vtkProperty* const property = skin.actor->GetProperty();
        property->SetAmbient(0.05);
        property->SetDiffuse(0.95);
        property->SetSpecular(0.10);
        property->SetSpecularPower(18);
        cloud.actor->GetProperty()->SetPointSize(2);
    }

    /// Frames the points of the skin; of the cloud where there is no skin.
    void measure(const std::vector<Eigen::Vector3d>& points, const RigidTransform& ct_from_points) {
        if (points.empty()) return;
        Eigen::Vector3d low = ct_from_points * points.front(), high = low;
        for (const Eigen::Vector3d& p : points) {
            low = low.cwiseMin(ct_from_points * p);
            high = high.cwiseMax(ct_from_points * p);
        }
        middle = 0.5 * (low + high);
        reach_mm = 0.60 * std::max({high.x() - low.x(), high.y() - low.y(), high.z() - low.z(), 1.0});
    }

    bool take_skin_and_markers(const SceneModel& scene) {
        const bool new_skin = replace(shown.skin, scene.skin);
        if (new_skin) {
            if (shown.skin) measure(shown.skin->vertices_in_ct, RigidTransform::Identity());
        }
        shown.of_scan = scene.of_scan;  // with a skin of its own
        const bool other_colours = replace(shown.skin_error_mm, scene.skin_error_mm) |
                                   replace(shown.warn_above_mm, scene.warn_above_mm) |
                                   replace(shown.stop_above_mm, scene.stop_above_mm);
        if (new_skin || other_colours) skin.show(shown.skin ? skin_shape(shown) : nullptr);
        if (!replace(shown.markers, scene.markers) && !new_skin) return other_colours;
        markers.show(shown.markers ? marker_shape(*shown.markers, middle) : nullptr);
        return true;
    }

    bool take_risks(const SceneModel& scene) {
        if (!replace(shown.risk_structures, scene.risk_structures)) return false;
        risks.show(shown.risk_structures ? risk_shape(*shown.risk_structures) : nullptr);
        return true;
    }

    bool take_cloud(const SceneModel& scene) {
        const bool other = replace(shown.cloud, scene.cloud) |
                           replace(shown.cloud_distance_mm, scene.cloud_distance_mm) |
                           replace(shown.largest_distance_mm, scene.largest_distance_mm);
        if (other)
            cloud.show(shown.cloud ? cloud_shape(*shown.cloud, shown.cloud_distance_mm.get(), shown.largest_distance_mm)
                                   : nullptr);
        const bool moved = !shown.ct_from_rig.matrix().isApprox(scene.ct_from_rig.matrix(), 0);
        shown.ct_from_rig = scene.ct_from_rig;
        if ((other || moved) && shown.cloud && !shown.skin) measure(shown.cloud->points_in_rig, shown.ct_from_rig);
        return other || (moved && shown.cloud);
    }

    bool take_lines(const SceneModel& scene) {
        const bool new_plan = replace(shown.plan, scene.plan) | replace(shown.bright_item, scene.bright_item),
                   new_light = replace(shown.light, scene.light);
        if (new_plan) plan.show(shown.plan ? plan_shape(*shown.plan, shown.bright_item) : nullptr);
        if (new_light) light.show(shown.light ? light_shape(*shown.light) : nullptr);
        return new_plan || new_light;
    }

    /// In a small picture the head is smaller, so that the letters at the edges do not stand on it.
    double between_letters() const {
        constexpr double kOfPicture = 1 / 1.2;  // the head's, as it is measured
        const double smaller = std::max(1, std::min(width, height));
        return std::clamp((1 - 2 * SceneOverlay::letters_reach_px(scale) / smaller) / kOfPicture, 0.5, 1.0);
    }

    double distance_mm() const {
        const double narrow = std::min(1.0, static_cast<double>(width) / std::max(1, height));
        return reach_mm / (std::tan(kHalfAngle) * narrow * shown_view.zoom * between_letters());
    }

    Eigen::Vector3d focus(const ViewAxes& axes) const {
        return middle - shown_view.shift_mm.x() * axes.right_in_ct - shown_view.shift_mm.y() * axes.up_in_ct;
    }
    Eigen::Vector3d eye(const ViewAxes& axes) const { return focus(axes) + distance_mm() * axes.backward_in_ct; }

    void place_camera() {
        const ViewAxes axes = axes_of(shown_view);
        const Eigen::Vector3d focus = this->focus(axes), eye = this->eye(axes);
        vtkCamera* const camera = renderer->GetActiveCamera();
        camera->SetViewAngle(2 * kHalfAngle * 180 / M_PI);
        camera->SetFocalPoint(focus.data());
        camera->SetPosition(eye.data());
        camera->SetViewUp(axes.up_in_ct.data());
        cloud.lift(eye, distance_mm(), shown.ct_from_rig);
        for (Thing* thing : {&markers, &plan, &light}) thing->lift(eye, distance_mm());
        place_planes(*camera);
    }

    /// All layers have one depth buffer. What lies within is drawn with depths before those of the skin, so that the
    /// skin does not hide it; it writes none, so that the skin hides what lies behind it on the head.
    void place_planes(vtkCamera& camera) {
        constexpr double kBefore = 0.2;  // of the way to the nearest: the skin's depths are above 0.8
        vtkBoundingBox all;
        for (vtkRenderer* layer : {renderer.Get(), upon.Get()})
            if (const vtkBoundingBox bounds(layer->ComputeVisiblePropBounds()); bounds.IsValid()) all.AddBox(bounds);
        if (all.IsValid()) {
            double bounds[6];
            all.GetBounds(bounds);
            renderer->ResetCameraClippingRange(bounds);
        }
        const double* const range = camera.GetClippingRange();
        camera.SetClippingRange(kBefore * range[0], range[1]);
        vtkCamera* const inner = within->GetActiveCamera();
        inner->DeepCopy(&camera);
        within->ResetCameraClippingRange();
        inner->SetClippingRange(inner->GetClippingRange()[0], 100 * inner->GetClippingRange()[1]);
    }
};

Scene::Scene(vtkRenderWindow& window, const FontFiles& fonts) : parts_(std::make_unique<Parts>(window, fonts)) {}
Scene::~Scene() = default;

bool Scene::update(const SceneModel& scene, const SceneView& view, int width, int height, double scale,
                   const Words* words, const LetterInsets& insets) {
    Parts& parts = *parts_;
    const bool changed = static_cast<int>(parts.take_skin_and_markers(scene)) |
                         static_cast<int>(parts.take_cloud(scene)) | static_cast<int>(parts.take_lines(scene)) |
                         static_cast<int>(parts.take_risks(scene));
    if (!changed && insets == parts.insets && view == parts.shown_view && width == parts.width &&
        height == parts.height)
        return false;
    if (scene.on_paper)
        parts.renderer->SetBackground(1, 1, 1);
    else
        parts.renderer->SetBackground(0.055, 0.067, 0.086);
    parts.shown_view = view;
    parts.insets = insets;
    parts.width = width;
    parts.height = height;
    parts.scale = scale;
    parts.cloud.actor->GetProperty()->SetPointSize(static_cast<float>(std::max(2.0, 2.2 * scale)));
    parts.place_camera();
    parts.overlay.update(scene, view, width, height, scale, words, insets);
    return true;
}

Ray Scene::sight(const Eigen::Vector2d& pixel) const {
    const ViewAxes axes = axes_of(parts_->shown_view);
    const double per_pixel = 2 * std::tan(kHalfAngle) / std::max(1, parts_->height);
    const double x = (pixel.x() + 0.5 - parts_->width / 2.0) * per_pixel,
                 y = (parts_->height / 2.0 - pixel.y() - 0.5) * per_pixel;
    return {parts_->eye(axes), (x * axes.right_in_ct + y * axes.up_in_ct - axes.backward_in_ct).normalized()};
}

Eigen::Vector2d Scene::pixel_of(const Eigen::Vector3d& p) const {
    const ViewAxes axes = axes_of(parts_->shown_view);
    const Eigen::Vector3d from_eye = p - parts_->eye(axes);
    const double depth = -axes.backward_in_ct.dot(from_eye),
                 per_pixel = 2 * std::tan(kHalfAngle) / std::max(1, parts_->height);
    return {parts_->width / 2.0 - 0.5 + axes.right_in_ct.dot(from_eye) / depth / per_pixel,
            parts_->height / 2.0 - 0.5 - axes.up_in_ct.dot(from_eye) / depth / per_pixel};
}

double Scene::mm_per_pixel() const {
    return 2 * parts_->distance_mm() * std::tan(kHalfAngle) / std::max(1, parts_->height);
}

}  // namespace planlight
