#pragma once

#include <memory>
#include <string>

#include "app/windows/guide_model.h"
#include "app/windows/operator_window.h"

namespace planlight {

/// The window of a guided calibration. All members are called from the main thread.
class GuideWindow {
public:
    /// Throws DeviceError as `OperatorWindow` does.
    explicit GuideWindow(const OperatorWindowSettings& settings = {});
    ~GuideWindow();

    /// Draws the model and says what the person wants: Enter keeps, Delete discards, Escape or closing it is `quit`.
    GuideAction frame(const GuideModel& model);

    /// What the last frame showed.
    RgbImage screenshot();

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace planlight
