#include "registration/devices/recorded_play.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace planlight {
namespace {

constexpr Instant kUsualInterval = std::chrono::milliseconds(40);

/// The usual time between two frames: the median; of a single frame 40 ms.
Instant interval_of(const std::vector<RecordedFrame>& frames) {
    std::vector<Instant> steps;
    for (std::size_t i = 1; i < frames.size(); ++i) steps.push_back(frames[i].at - frames[i - 1].at);
    if (steps.empty()) return kUsualInterval;
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::nth_element(steps.begin(), middle, steps.end());
    return *middle;
}

}  // namespace

RecordedPlay::RecordedPlay(std::vector<RecordedFrame> frames, RecordedPace pace, Instant began,
                           std::shared_ptr<const RecordedLight> light)
    : frames_(std::move(frames)), pace_(pace), began_(began), light_(std::move(light)) {
    if (frames_.empty()) throw std::invalid_argument("RecordedPlay: no frames");
    round_ = frames_.back().at - frames_.front().at + interval_of(frames_);
}

Instant RecordedPlay::at_own_pace(std::uint64_t number) const {
    const std::uint64_t rounds = (number - 1) / frames_.size();
    const RecordedFrame& first = frames_.front();
    return began_ + first.exposure / 2 + static_cast<Instant::rep>(rounds) * round_ +
           (frames_[(number - 1) % frames_.size()].at - first.at);
}

RecordedPlay::Exposure RecordedPlay::exposure(std::uint64_t number, Instant at) const {
    const RecordedFrame& frame = frames_[(number - 1) % frames_.size()];
    Exposure exposure{number, at, frame.exposure, frame.picture, number > 1 ? frame.lost : 0};
    if (light_)
        if (const auto lit = light_->at(at - frame.exposure / 2)) exposure.picture = *lit;
    return exposure;
}

/// Both cameras are given the same moment, whichever asks first; neither gets the next before the other has this one.
std::optional<RecordedPlay::Exposure> RecordedPlay::next_at_once(std::uint64_t after, Instant now) {
    constexpr int kCameras = 2;
    const std::lock_guard lock(mutex_);
    if (given_.number == after + 1) {
        ++given_to_;
        return given_;
    }
    if (given_.number > 0 && given_to_ < kCameras) return std::nullopt;
    Instant at = now + frames_[after % frames_.size()].exposure / 2;
    if (given_.number > 0) at = std::max(at, given_.at + std::chrono::microseconds(1));
    given_ = exposure(after + 1, at);
    given_to_ = 1;
    return given_;
}

std::vector<RecordedPlay::Exposure> RecordedPlay::due(std::uint64_t after, Instant now, std::size_t most) {
    if (pace_ == RecordedPace::fastest) {
        const auto next = next_at_once(after, now);
        return next ? std::vector<Exposure>{*next} : std::vector<Exposure>{};
    }
    if (now < began_) return {};
    // All numbers up to this one's round are over; in that round it is looked.
    std::uint64_t last = static_cast<std::uint64_t>((now - began_) / round_) * frames_.size();
    for (std::size_t i = 0; i < frames_.size(); ++i) {
        const std::uint64_t number = last + 1;
        if (at_own_pace(number) + frames_[(number - 1) % frames_.size()].exposure / 2 > now) break;
        last = number;
    }
    std::vector<Exposure> exposures;
    const std::uint64_t first = std::max(after + 1, last >= most ? last - most + 1 : 1);
    for (std::uint64_t number = first; number <= last; ++number)
        exposures.push_back(exposure(number, at_own_pace(number)));
    return exposures;
}

}  // namespace planlight
