#pragma once

#include <memory>

#include "app/windows/camera_page_model.h"
#include "app/windows/window_settings.h"

namespace planlight {

/// The window on which cameras are aimed, focused and exposed. All members are called from the main thread.
class CameraPage {
public:
    /// Throws DeviceError when there is no display, no such monitor, no OpenGL 3.3, or no font.
    explicit CameraPage(const WindowSettings& settings = {});
    ~CameraPage();

    /// Draws the model where it has changed, and says what the person wants. DARK is taken as it is pressed, not
    /// released; Q or closing the window is `quit`.
    CameraPageAction frame(const CameraPageModel& model);

    /// Waits until the person does something, `longest_s` at most.
    void rest(double longest_s);

    /// What the last frame showed.
    RgbImage screenshot();

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace planlight
