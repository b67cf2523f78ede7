#pragma once

#include <map>
#include <string>

#include "app/windows/operator_keys.h"
#include "app/windows/operator_model.h"
#include "app/windows/pen.h"
#include "app/windows/scene_pane.h"

namespace planlight {

/// The views of the 3-D picture by a press: from the patient's front, back, sides and above, as the light falls, as the
/// surgeon stands, and as at first. The projector's view follows the projector while nobody turns the picture.
class ViewButtons {
public:
    /// Turns the picture; a sentence says why not. Empty, and nothing is done, for a key of another meaning.
    std::string press(KeyMeaning key, const OperatorModel& model, ScenePane& scene);

    /// Before the picture is drawn: the view that follows something is brought up to it.
    void follow(const OperatorModel& model, ScenePane& scene);

    /// The button that opens them, in its place; then they stand below.
    void draw_opener(const Pen& pen, const Box& box);
    void draw(const Pen& pen, const Box& place, const OperatorModel& model, ScenePane& scene);
    bool open() const { return open_; }
    /// How much of the picture's upper edge they take, while they are open.
    static float height(float scale);

    const std::map<std::string, Box>& places() const { return places_; }

private:
    bool open_ = false;
    KeyMeaning chosen_ = KeyMeaning::none;  ///< none: the person turned it since
    SceneView looked_;                      ///< as it was chosen
    std::map<std::string, Box> places_;
};

}  // namespace planlight
