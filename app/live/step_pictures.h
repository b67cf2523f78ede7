#pragma once

#include <filesystem>
#include <string>

#include "app/windows/operator_model.h"
#include "planning_io/types/image.h"

namespace planlight {

class OperatorWindow;

/// Screenshots of the operator window, for their owner alone: one whenever the status says another thing or something
/// else is asked, once the window has settled. Called BEGIN-NUMBER-STATE.png:
/// operator-09-check-light-1-is-right.png.
class StepPictures {
public:
    /// `folder` is made; empty: nothing is taken.
    StepPictures(std::filesystem::path folder, std::string begin);

    /// At each look at the session. What stands behind the first word of the picture that was taken, to name others of
    /// that moment ("09-check-light-1-is-right.png"); empty: none was, or it could not be kept.
    std::string take(OperatorWindow& window, const OperatorModel& model);
    const std::filesystem::path& folder() const { return folder_; }

private:
    std::filesystem::path folder_;
    std::string begin_, state_;  ///< the state at the look before
    int looks_ = 0, number_ = 0;
};

/// Such a picture for its owner alone. What the disk does not take is said as a warning, and false: no session ends,
/// and no light goes out, for a screenshot.
bool keep_or_warn(const RgbImage& picture, const std::filesystem::path& file);

}  // namespace planlight
