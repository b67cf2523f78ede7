#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/windows/operator_model.h"
#include "app/windows/window_settings.h"
#include "planning_io/types/point_pair.h"

namespace planlight {

/// The window for the person at the trolley. All members are called from the main thread.
class OperatorWindow {
public:
    /// Throws DeviceError when there is no display, no such monitor, no OpenGL 3.3, or no font.
    explicit OperatorWindow(const WindowSettings& settings = {});
    ~OperatorWindow();

    /// Takes in what was pressed, draws the model where that shows anything new, and says what the person wants. `dark`
    /// comes before all else, drawing too.
    ///
    /// DARK acts when it is pressed, not when released, and by the keys Space, B, Escape and Page Up. Every button has
    /// a key, which stands in it; Page Down and Enter press the one that leads on. Closing the window is `quit`; while
    /// the model's light is on it is asked first. A press of what is not enabled is answered with the reason.
    OperatorAction frame(const OperatorModel& model);

    /// An answer to the last press, shown for some seconds; empty: nothing.
    void say(const std::string& answer);

    /// Why the last press did nothing, as it stands in the window; empty: it did something, or some seconds ago.
    const std::string& answer() const;

    /// Waits until the person does something, `longest_s` at most. A loop that draws no more than it must calls this
    /// after every frame.
    void rest(double longest_s);
    /// Nobody sees it, and none of its keys is heard.
    bool put_away() const;
    /// Another window has the keyboard: neither a key nor a pedal reaches DARK.
    bool keyboard_is_elsewhere() const;
    /// How often the window was drawn so far.
    std::size_t frames_drawn() const;

    /// What the last frame showed.
    RgbImage screenshot();

    /// With `light_item`, `hide_item` and `show_item`: the row of the plan; empty: all of it.
    std::optional<std::size_t> item_wanted() const;

    /// What the 3-D view shows of a match; the person changes it with the buttons over the view.
    FitView fit_view() const;
    void set_fit_view(FitView view);

    /// From where the head is looked at; the person turns it with the mouse.
    SceneView view() const;
    void set_view(const SceneView& view);

    /// Shows the skin from CT and the scan side by side, to click landmarks on both, with `pairs` already there; in the
    /// next frames whose model has landmarks. The person opens it by the button "Landmarks".
    void open_landmarks(const std::vector<PointPair>& pairs = {});
    /// Shows the page of the plan and the evidence; the person opens it by a press on the table.
    void open_evidence();
    /// Shows the buttons of the views; the person opens them by the button "Views".
    void open_views();
    /// What has been clicked on both sides, of the scan that the last frame's model had; empty before.
    std::vector<PointPair> landmarks() const;

    /// Where a control is, in window pixels (x, y, width, height), as the last frame drew it; for tests by mouse.
    std::array<int, 4> place_of(OperatorAction control) const;
    /// The same for other controls by their word: before, after, error, landmarks, check-skin, evidence, views,
    /// left-camera, right-camera; while landmarks are clicked: undo, turn, use, close, skin-view, scan-view; on the
    /// page of the evidence: close, item-1, hide-1 and so on; while it is asked whether to close the window:
    /// close-window, stay. Zeros for what was not drawn.
    std::array<int, 4> place_of(const std::string& button) const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace planlight
