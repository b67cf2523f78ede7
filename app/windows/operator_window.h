#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/windows/operator_model.h"
#include "planning_io/types/point_pair.h"

namespace planlight {

/// What the operator pressed, by mouse, key or pedal.
enum class OperatorAction { none, scan, do_register, track, stop, dark, quit, confirm, use_landmarks, check_skin };

struct OperatorWindowSettings {
    std::string title = "Planlight";
    int width = 1920, height = 1080;     ///< pixels; at most the monitor's, at least 1280 x 800
    std::optional<std::string> monitor;  ///< name or index as text; the primary one when not given
    bool fill_monitor = false;           ///< borderless over that whole monitor
};

/// The window for the person at the trolley. All members are called from the main thread.
class OperatorWindow {
public:
    /// Throws DeviceError when there is no display, no such monitor, no OpenGL 3.3, or no font.
    explicit OperatorWindow(const OperatorWindowSettings& settings = {});
    ~OperatorWindow();

    /// Takes in what was pressed, draws the model, and says what the person wants; `dark` comes before all else.
    ///
    /// DARK acts when it is pressed, not when released, and by the keys Space, B and Escape. Closing the window is
    /// `quit`.
    OperatorAction frame(const OperatorModel& model);

    /// What the last frame showed.
    RgbImage screenshot();

    /// What the 3-D view shows of a match; the person changes it with the buttons over the view.
    FitView fit_view() const;
    void set_fit_view(FitView view);

    /// From where the head is looked at; the person turns it with the mouse.
    SceneView view() const;
    void set_view(const SceneView& view);

    /// Shows the skin from CT and the scan side by side, to click landmarks on both, with `pairs` already there; in the
    /// next frames whose model has landmarks. The person opens it by the button "Landmarks".
    void open_landmarks(const std::vector<PointPair>& pairs = {});
    /// What has been clicked on both sides, of the scan that the last frame's model had; empty before.
    std::vector<PointPair> landmarks() const;

    /// Where a control is, in window pixels (x, y, width, height), as the last frame drew it; for tests by mouse.
    std::array<int, 4> place_of(OperatorAction control) const;
    /// The same for a control over the 3-D view by its word: before, after, error, landmarks, check-skin; while these
    /// are clicked: undo, turn, use, close, skin-view, scan-view. Zeros for what was not drawn.
    std::array<int, 4> place_of(const std::string& button) const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace planlight
