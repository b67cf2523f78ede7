#include "app/live/skin_check_schedule.h"

#include <fmt/format.h>

#include <algorithm>

namespace planlight {

void SkinCheckSchedule::restart() {
    announced_at_.reset();
    seen_.clear();
}

void SkinCheckSchedule::began(Instant at) {
    restart();
    began_at_ = at;
    ++unanswered_;
}

bool SkinCheckSchedule::due(Instant at, Instant known_at) {
    if (began_at_ && known_at > *began_at_) began_at_.reset(), unanswered_ = 0;
    if (at - known_at < *settings_.every) return false;
    if (!began_at_) return true;
    constexpr int kMostDoublings = 10;
    const Instant longer = settings_.again_after * (1 << std::clamp(unanswered_ - 1, 0, kMostDoublings));
    return at - *began_at_ >= std::max(settings_.again_after, std::min(longer, *settings_.every));
}

/// Whether it has, for as long as is asked. A marker fewer or more is a reference of another scan: seen anew.
bool SkinCheckSchedule::still(Instant at, const std::vector<Eigen::Vector3d>& markers) {
    const auto moved = [&](const Seen& seen) {
        if (seen.markers.size() != markers.size()) return true;
        for (std::size_t i = 0; i < markers.size(); ++i)
            if ((seen.markers[i] - markers[i]).norm() > settings_.still_mm) return true;
        return false;
    };
    if (markers.empty() || std::ranges::any_of(seen_, moved)) seen_.clear();
    if (markers.empty()) return false;
    seen_.push_back({at, markers});
    while (seen_.size() > 2 && at - seen_[1].at >= settings_.still_for) seen_.pop_front();
    return at - seen_.front().at >= settings_.still_for;
}

SkinCheckSchedule::Turn SkinCheckSchedule::step(Instant at, Instant known_at, bool lit,
                                                const std::vector<Eigen::Vector3d>& markers) {
    if (!settings_.every) return {};
    if (last_at_ && at - *last_at_ > settings_.gap) restart();
    last_at_ = at;
    const bool lies_still = still(at, markers);
    if (!due(at, known_at) || !lit) {
        announced_at_.reset();
        return {};
    }
    if (!announced_at_) announced_at_ = at;
    const Instant left = *announced_at_ + settings_.announced_for - at;
    if (left > Instant{}) {
        const auto seconds = std::chrono::ceil<std::chrono::seconds>(left).count();
        return {false, fmt::format("The skin is checked in {} s: keep the patient still.", seconds)};
    }
    if (!lies_still && -left > settings_.waits_at_most) {
        began(at);
        return {};
    }
    return {lies_still, "The skin is checked as soon as the patient lies still."};
}

}  // namespace planlight
