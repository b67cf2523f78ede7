#include "registration/devices/exposure_times.h"

#include <algorithm>
#include <cmath>

namespace planlight {
namespace {

constexpr std::size_t kMost = 9;
constexpr std::size_t kLeast = 5;
constexpr double kEven = 0.02;  // of a step: how far one may be off a whole number of the least
constexpr Instant kFarthest = std::chrono::seconds(1);
constexpr Instant kMargin = std::chrono::milliseconds(1);  // of what is expected

}  // namespace

void ExposureTimes::add(const CameraFrame& frame) {
    // A clock that was set, another exposure, or long ago: what was before tells nothing.
    if (!frames_.empty()) {
        const Instant since = frame.at - frames_.back().at;
        if (since <= Instant{} || since > kFarthest || frame.exposure != frames_.back().exposure) frames_.clear();
    }
    frames_.push_back({frame.at, frame.exposure, frame.at_sigma});
    if (frames_.size() > kMost) frames_.pop_front();
}

std::optional<ExposureTimes::Expected> ExposureTimes::first_after(Instant not_before) const {
    if (frames_.size() < kLeast) return std::nullopt;
    Instant least = Instant::max();
    for (std::size_t i = 1; i < frames_.size(); ++i) least = std::min(least, frames_[i].at - frames_[i - 1].at);
    // Lost frames leave steps of twice or three times the least.
    double steps = 0;
    for (std::size_t i = 1; i < frames_.size(); ++i) {
        const double these = seconds(frames_[i].at - frames_[i - 1].at) / seconds(least);
        const double whole = std::round(these);
        if (std::abs(these - whole) > kEven * whole) return std::nullopt;
        steps += whole;
    }
    const Frame& last = frames_.back();
    const double step_s = seconds(last.at - frames_.front().at) / steps;
    const Instant vague = 2 * last.sigma + kMargin;
    const Instant begins = last.at - last.exposure / 2;
    const double ahead = std::max(0.0, std::ceil(seconds(not_before + vague - begins) / step_s));
    if (ahead * step_s > seconds(kFarthest)) return std::nullopt;
    const Instant at = last.at + from_seconds(ahead * step_s);
    return Expected{at, last.exposure, at + last.exposure / 2 + vague};
}

}  // namespace planlight
