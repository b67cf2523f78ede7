#pragma once

#include <memory>

#include "app/windows/doctor_page_model.h"
#include "app/windows/window_settings.h"
#include "planning_io/types/image.h"

namespace planlight {

/// The window on which a room is examined before a patient comes. All members are called from the main thread.
class DoctorPage {
public:
    /// Throws DeviceError when there is no display, no such monitor, no OpenGL 3.3, or no font.
    explicit DoctorPage(WindowSettings settings = {});
    ~DoctorPage();

    /// Draws the model where it has changed, and says what the person wants. DARK is taken as it is pressed, not
    /// released; Q or closing the window is `quit`, Enter is `again` once it is over. The arrows and the wheel move the
    /// lines where there are more than have room.
    DoctorPageAction frame(const DoctorPageModel& model);

    /// Waits until the person does something, `longest_s` at most.
    void rest(double longest_s);

    /// What the last frame showed.
    RgbImage screenshot();

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace planlight
