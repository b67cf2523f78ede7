#pragma once

#include <memory>

#include "app/windows/fonts.h"
#include "app/windows/operator_model.h"
#include "app/words/words.h"

class vtkRenderer;

namespace planlight {

/// How far buttons reach over the picture at its left and right middle, pixels: the letters there stand beside them.
struct LetterInsets {
    double left = 0, right = 0;

    bool operator==(const LetterInsets&) const = default;
};

/// The letters R L A P S I at the edges of the 3-D view, and the legend of the cloud's colours.
class SceneOverlay {
public:
    SceneOverlay(vtkRenderer& renderer, const FontFiles& fonts);
    ~SceneOverlay();

    /// How far the letters reach into the picture from its edges, pixels.
    static double letters_reach_px(double scale);

    /// For a picture of that many pixels; `scale` 1 is for a 1080-line screen.
    void update(const SceneModel& scene, const SceneView& view, int width, int height, double scale,
                const Words* words = nullptr, const LetterInsets& insets = {});

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace planlight
