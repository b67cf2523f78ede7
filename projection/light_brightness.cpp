#include "projection/light_brightness.h"

#include <algorithm>

namespace planlight {

double LightBrightness::look(const LightCheck& check) {
    constexpr int kLeastSeen = 5;
    constexpr double kLeastSeenShare = 0.5;
    const bool seen = check.seen >= kLeastSeen && check.seen_share() >= kLeastSeenShare;
    if (!seen || check.brighter < settings_.least_brighter)
        share_ *= 1 + settings_.step;
    else if (check.brighter > settings_.most_brighter && check.fainter > settings_.least_fainter &&
             check.brighter * check.background > settings_.least_grey)
        share_ *= 1 - settings_.step;
    share_ = std::clamp(share_, settings_.least, 1.0);
    return share_;
}

}  // namespace planlight
