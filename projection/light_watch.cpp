#include "projection/light_watch.h"

#include <algorithm>

namespace planlight {

const std::vector<LightCause>& LightWatch::add(LightFacts facts) {
    constexpr double kMostSeen = 0.8, kSlow = 0.05;
    const Instant keep_from = facts.at - settings_.long_window;
    std::erase_if(facts_, [&](const LightFacts& f) { return f.at < keep_from || f.at >= facts.at; });
    const bool looked = facts.expected > 0;
    if (looked && facts.seen > kMostSeen * facts.expected)
        usual_background_ =
            usual_background_ > 0 ? (1 - kSlow) * usual_background_ + kSlow * facts.background : facts.background;
    const bool lost = !facts.pose;
    facts_.push_back(std::move(facts));
    if (looked || lost) causes_ = find_causes(facts_, rig_, usual_background_, settings_);
    return causes_;
}

void LightWatch::forget() {
    facts_.clear();
    causes_.clear();
}

}  // namespace planlight
