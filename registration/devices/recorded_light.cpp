#include "registration/devices/recorded_light.h"

namespace planlight {

void RecordedLight::shows(std::optional<std::size_t> picture, Instant from, Instant until) {
    constexpr std::size_t kMost = 16;
    const std::lock_guard lock(mutex_);
    orders_.push_back({picture, from, until});
    if (orders_.size() > kMost) orders_.pop_front();
}

std::optional<std::size_t> RecordedLight::at(Instant moment) const {
    const std::lock_guard lock(mutex_);
    for (auto order = orders_.rbegin(); order != orders_.rend(); ++order)
        if (order->from <= moment) return moment < order->until ? order->picture : std::nullopt;
    return std::nullopt;
}

}  // namespace planlight
