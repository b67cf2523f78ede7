#include "app/windows/time_line.h"

#include <algorithm>

namespace planlight {
namespace {

constexpr double kSame_s = 1e-6;

}  // namespace

std::size_t frame_near(const TimeLine& line, double at_s) {
    const auto& all = line.frames_s;
    const auto after = std::lower_bound(all.begin(), all.end(), at_s);
    if (after == all.begin()) return 0;
    const bool before = after == all.end() || at_s - *(after - 1) <= *after - at_s;
    return static_cast<std::size_t>(after - all.begin()) - (before ? 1 : 0);
}

std::optional<std::size_t> event_at(const TimeLine& line, double at_s) {
    const auto after = std::upper_bound(line.events.begin(), line.events.end(), at_s + kSame_s,
                                        [](double s, const TimeLine::Event& event) { return s < event.at_s; });
    if (after == line.events.begin()) return std::nullopt;
    return static_cast<std::size_t>(after - line.events.begin()) - 1;
}

std::optional<double> next_event_s(const TimeLine& line, double at_s) {
    const auto before = event_at(line, at_s);
    const std::size_t next = before ? *before + 1 : 0;
    return next < line.events.size() ? std::optional(line.events[next].at_s) : std::nullopt;
}

std::optional<double> event_before_s(const TimeLine& line, double at_s) {
    const auto before = event_at(line, at_s - 2 * kSame_s);
    return before ? std::optional(line.events[*before].at_s) : std::nullopt;
}

const TimeLine::Stretch* stretch_at(const TimeLine& line, double at_s) {
    const auto after = std::upper_bound(line.stretches.begin(), line.stretches.end(), at_s + kSame_s,
                                        [](double s, const TimeLine::Stretch& one) { return s < one.from_s; });
    if (after == line.stretches.begin() || (after - 1)->to_s < at_s - kSame_s) return nullptr;
    return &*(after - 1);
}

}  // namespace planlight
