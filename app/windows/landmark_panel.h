#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "app/windows/landmark_clicks.h"
#include "app/windows/operator_model.h"
#include "app/windows/scene_pane.h"

namespace planlight {

/// Under the two views: take back a click, turn the scan, use what was clicked, leave.
enum class LandmarkButton { undo, turn, use, close };

/// In the place of the 3-D view: the skin from CT on the left, the scan on the right, both to be turned and clicked.
class LandmarkPanel {
public:
    LandmarkPanel(const FontFiles& fonts, std::function<void()> make_current);

    /// Another scan than before: what was clicked on the last one is forgotten. Before every `draw`, and without one.
    void follow(const LandmarkViews& views);

    /// What was pressed.
    std::optional<LandmarkButton> draw(const Pen& pen, const Box& box, const LandmarkViews& views,
                                       const std::string& use_label);

    /// What its button does, and why it cannot do it now: a sentence, empty where it can.
    void press(LandmarkButton which);
    std::string why_not(LandmarkButton which) const;

    LandmarkClicks& clicks() { return clicks_; }
    const LandmarkClicks& clicks() const { return clicks_; }
    void set_skin_view(const SceneView& view) { skin_pane_.set_view(view); }

    /// Where the buttons and the views were drawn last, by their words: undo, turn, use, close, skin-view, scan-view.
    std::map<std::string, Box> places() const;

private:
    void take_clicks(const LandmarkViews& views);
    void draw_panes(const Pen& pen, const LandmarkViews& views);
    Eigen::Isometry3d turned() const;
    void draw_words(const Pen& pen, const Box& box) const;
    bool can(LandmarkButton which) const;
    std::optional<LandmarkButton> draw_buttons(const Pen& pen, const Box& strip, const std::string& use_label);

    LandmarkClicks clicks_;
    ScenePane skin_pane_, scan_pane_;
    SceneModel skin_scene_, scan_scene_;
    std::shared_ptr<const ClickableScan> scan_;
    std::string notice_;     ///< why the last click did not count
    int quarter_turns_ = 0;  ///< of the scan, about the way it is looked at: the devices may hang upside down
    std::array<Box, 2> boxes_{};
    std::array<Box, 4> buttons_{};  ///< by LandmarkButton
};

}  // namespace planlight
