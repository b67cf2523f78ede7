#pragma once

#include <memory>

#include "app/windows/guide_model.h"
#include "app/windows/window_settings.h"

namespace planlight {

/// The window of a guided calibration. All members are called from the main thread.
class GuideWindow {
public:
    /// Throws DeviceError when there is no display, no such monitor, no OpenGL 3.3, or no font.
    explicit GuideWindow(WindowSettings settings = {});
    ~GuideWindow();

    /// Draws the model and says what the person wants: Enter keeps, Delete discards, Escape or closing it is `quit`.
    GuideAction frame(const GuideModel& model);

    /// Waits until the person does something, `longest_s` at most.
    void rest(double longest_s);

    /// What the last frame showed.
    RgbImage screenshot();

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace planlight
