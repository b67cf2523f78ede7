#pragma once

#include <imgui.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkSmartPointer.h>

#include <chrono>
#include <functional>
#include <memory>
#include <optional>

#include "app/windows/operator_model.h"
#include "app/windows/pen.h"
#include "app/windows/scene.h"

namespace planlight {

/// A 3-D view in its place in the operator window: its picture, and the mouse that turns it. Made, used and destroyed
/// with the window's context current.
class ScenePane {
public:
    ScenePane(const FontFiles& fonts, std::function<void()> make_current);
    ~ScenePane();
    ScenePane(const ScenePane&) = delete;
    ScenePane& operator=(const ScenePane&) = delete;

    /// Left turns, right or middle shifts, wheel zooms, a double click goes back to the first view. Returns where the
    /// left button was pressed and released without moving, in window pixels.
    std::optional<ImVec2> take_mouse(const char* name, const Box& sensitive);

    /// Renders what has changed and draws the picture into the box. Where only the scene changed, not the view, it is
    /// rendered in a third of the time at most, so that a slow machine has time for the rest; `wants_frame` then.
    void draw(const Pen& pen, const Box& box, const SceneModel& model, const LetterInsets& insets = {});

    /// The picture is behind what was drawn last, and may be rendered now.
    bool wants_frame() const;

    /// The line of sight through a window pixel, and the window pixel of a point, in the scene's frame, as last drawn.
    Ray sight(const ImVec2& window_pixel) const;
    ImVec2 pixel_of(const Eigen::Vector3d& p) const;

    /// Millimetres of the head that a pixel in the middle covers.
    double mm_per_pixel() const { return scene_->mm_per_pixel(); }

    const SceneView& view() const { return view_; }
    void set_view(const SceneView& view) { view_ = first_view_ = view; }
    /// From there, until the person turns it; a double click still goes back to the first view.
    void look(const SceneView& view) { view_ = view; }
    const SceneView& first_view() const { return first_view_; }

private:
    vtkSmartPointer<vtkGenericOpenGLRenderWindow> target_;
    std::unique_ptr<Scene> scene_;
    SceneView view_, first_view_;
    SceneView rendered_view_;
    SceneModel rendered_;
    LetterInsets rendered_insets_;
    bool behind_ = false;
    std::chrono::steady_clock::time_point not_before_{};
    ImVec2 corner_{0, 0};  ///< of the picture, window pixels
};

}  // namespace planlight
