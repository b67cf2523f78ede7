#pragma once

#include <vector>

#include "projection/light_cause.h"

namespace planlight {

/// Keeps what the frames of the last seconds told, and says what is wrong with the light.
class LightWatch {
public:
    explicit LightWatch(const RigCalibration& rig, const LightCauseSettings& settings = {})
        : rig_(rig), settings_(settings) {}

    /// One frame; the causes are found anew when CHECK looked or the pose is lost.
    const std::vector<LightCause>& add(LightFacts facts);
    const std::vector<LightCause>& causes() const { return causes_; }

    /// What was seen until now is of another light: it was dark, corrected, or drawn by another match.
    void forget();

private:
    RigCalibration rig_;
    LightCauseSettings settings_;
    std::vector<LightFacts> facts_;
    std::vector<LightCause> causes_;
    double usual_background_ = 0;  ///< while most of the light was seen; slow mean
};

}  // namespace planlight
