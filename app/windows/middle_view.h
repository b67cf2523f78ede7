#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "app/windows/evidence_page.h"
#include "app/windows/landmark_panel.h"
#include "app/windows/operator_keys.h"
#include "app/windows/operator_model.h"
#include "app/windows/scene_pane.h"
#include "app/windows/view_buttons.h"

namespace planlight {

/// The large place in the middle of the window: the 3-D view with the buttons over it, or the landmarks, or the page of
/// the evidence instead.
class MiddleView {
public:
    MiddleView(const FontFiles& fonts, std::function<void()> make_current);

    /// `confirm`, `check_skin`, `use_landmarks`, `light_item`, `hide_item`, `show_item` or nothing.
    OperatorAction draw(const Pen& pen, const Box& place, const OperatorModel& model);

    /// What a key does here; `why_not` says why it did nothing, and is empty where it did something.
    OperatorAction press(KeyMeaning key, const OperatorModel& model);
    const std::string& why_not() const { return why_not_; }

    /// With `light_item`, `hide_item` and `show_item`: which row of the plan; empty: all of it.
    std::optional<std::size_t> item_wanted() const { return item_wanted_; }
    /// The row of the plan that the arrow keys have marked; empty: none.
    std::optional<std::size_t> marked_row() const { return marked_; }

    /// The 3-D view is behind the model and is to be drawn again soon.
    bool wants_frame() const { return scene_.wants_frame(); }

    /// From the next frame on; a frame whose model has no landmarks closes them.
    LandmarkPanel& open_landmarks();
    const LandmarkPanel* landmarks() const { return landmarks_.get(); }  ///< null: never opened

    ScenePane& scene() { return scene_; }
    Box place_of(const std::string& button) const;
    FitView fit_view = FitView::after;

private:
    OperatorAction draw_landmarks(const Pen& pen, const Box& place, const OperatorModel& model);
    void draw_scene(const Pen& pen, const Box& place, const OperatorModel& model);
    void draw_title(const Pen& pen, const Box& place, const OperatorModel& model, const SceneModel& shown) const;
    void draw_fit_buttons(const Pen& pen, const Box& row, const OperatorModel& model);
    OperatorAction press_item(KeyMeaning key, const OperatorModel& model);
    OperatorAction press_landmarks(LandmarkButton which);
    OperatorAction hide_or_show(std::size_t row, const OperatorModel& model);
    void mark_row(KeyMeaning key, const OperatorModel& model);
    void look_at_what_is_lit(const Pen& pen, const Box& place, const Box& free, const OperatorModel& model);
    OperatorAction draw_corner_buttons(const Pen& pen, Box corner, const OperatorModel& model);

    FontFiles fonts_;
    std::function<void()> make_current_;
    ScenePane scene_;
    ViewButtons views_;
    std::optional<LookAt> looked_at_;       ///< in the last frame
    std::optional<SceneView> view_before_;  ///< the picture was turned to it
    std::optional<std::size_t> item_wanted_, marked_;
    std::unique_ptr<LandmarkPanel> landmarks_;  ///< from the first time it was opened
    EvidencePage evidence_;
    bool landmarks_open_ = false, evidence_open_ = false;
    std::string why_not_;
    std::map<std::string, Box> places_;
};

}  // namespace planlight
