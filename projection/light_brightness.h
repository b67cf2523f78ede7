#pragma once

#include "projection/check_light.h"

namespace planlight {

/// How much brighter than the skin beside them the lines shall be.
struct LightBrightnessSettings {
    double most_brighter = 4;     ///< lines this many times as bright again as the skin beside them are dimmed
    double least_brighter = 2.5;  ///< and below this have their light back
    double least_fainter = 1;     ///< lines are dimmed only where their faintest fifth is this much brighter, too
    double least_grey = 60;       ///< of 255, above the skin, to a camera: lines that are fainter are not dimmed
    double least = 0.3;           ///< share of the projector's light that is always kept
    double step = 0.05;           ///< the most that one look at the light changes it, as a share of itself
};

/// The light's brightness follows that of the room: under the lamps of a theatre all of the projector's light, in a
/// dark room less of it, so that it dazzles nobody and cameras are not saturated.
///
/// What CHECK measures decides: the lines against the skin beside them. Where it sees too little of the light, all of
/// it comes back. Starts with all of it.
class LightBrightness {
public:
    explicit LightBrightness(const LightBrightnessSettings& settings = {}) : settings_(settings) {}
    /// What one look at the light says. Returns `share()`.
    double look(const LightCheck& check);
    double share() const { return share_; }  ///< of the projector's light, `least` to 1 (`RenderSettings::brightness`)

private:
    LightBrightnessSettings settings_;
    double share_ = 1;
};

}  // namespace planlight
