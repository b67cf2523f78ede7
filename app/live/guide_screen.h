#pragma once

#include "app/live/guided_calibration.h"
#include "app/windows/guide_model.h"

namespace planlight {

/// What the window shows of a guided calibration.
GuideModel guide_model_of(const GuideState& state, const std::string& title, const std::string& subtitle);

}  // namespace planlight
