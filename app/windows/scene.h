#pragma once

#include <memory>

#include "app/windows/fonts.h"
#include "app/windows/operator_model.h"
#include "app/windows/scene_overlay.h"
#include "app/words/words.h"
#include "planning_io/types/camera_model.h"

class vtkRenderWindow;

namespace planlight {

/// The 3-D view in a VTK render window that somebody else owns.
class Scene {
public:
    Scene(vtkRenderWindow& window, const FontFiles& fonts);
    ~Scene();

    /// Takes over what has changed; true when the picture must be rendered again.
    /// `words`: of the legend; null: English.
    bool update(const SceneModel& scene, const SceneView& view, int width, int height, double scale,
                const Words* words = nullptr, const LetterInsets& insets = {});

    /// The line of sight through a pixel of the last picture (from its top left), and the pixel of a point; in the
    /// scene's frame.
    Ray sight(const Eigen::Vector2d& pixel) const;
    Eigen::Vector2d pixel_of(const Eigen::Vector3d& p) const;

    /// Millimetres of the head that a pixel in the middle of the last picture covers.
    double mm_per_pixel() const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace planlight
