#include "registration/devices/device_clock.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace planlight {
namespace {

constexpr std::size_t kParts = 8;       // of the window, the quickest frame of each makes the line
constexpr std::size_t kJumpFrames = 3;  // so many late frames in a row are no hiccup of the computer
constexpr std::size_t kFewFrames = 20;  // of fewer the quickest may still have come late
constexpr Instant kFewSigma{5'000'000};
constexpr Instant kArrivalNoise{100'000};  // of the quickest arrivals, one standard deviation

Instant scaled(Instant t, double factor) {
    return Instant(static_cast<Instant::rep>(std::llround(static_cast<double>(t.count()) * factor)));
}

}  // namespace

DeviceClock::DeviceClock(const DeviceClockSettings& settings) : settings_(settings) {}

bool DeviceClock::add(Instant by_device, Instant arrived) {
    bool steady = true;
    if (known()) {
        const Instant off = arrived - on_session_clock(by_device);
        const bool backwards = by_device<frames_.back().by_device, late = off> settings_.largest_jump;
        if (!late)
            late_since_ = Instant(-1);
        else if (late_since_ < Instant{})
            late_since_ = by_device;
        // Earlier than any frame can be: at once. Later: only when it stays so.
        const bool stays_late = late && by_device - late_since_ > settings_.late_for;
        if (backwards || off < -settings_.largest_jump || stays_late) {
            frames_.clear();
            late_since_ = Instant(-1);
            drift_ = 0;
            ++jumps_;
            steady = false;
        } else if (late) {
            return true;  // it tells nothing of the clock
        }
    }
    frames_.push_back({by_device, arrived - by_device});
    while (by_device - frames_.front().by_device > settings_.window) frames_.pop_front();
    fit();
    return steady;
}

void DeviceClock::fit() {
    const Instant first = frames_.front().by_device, span = frames_.back().by_device - first;
    const auto quicker = [](const Frame& a, const Frame& b) { return a.late < b.late; };
    if (span < settings_.drift_known_after) {
        const Frame& best = *std::min_element(frames_.begin(), frames_.end(), quicker);
        origin_ = best.by_device;
        offset_ = best.late;
        drift_ = 0;
        sigma_ = kArrivalNoise + scaled(frames_.back().by_device - origin_, settings_.largest_drift) +
                 (frames_.size() < kFewFrames ? kFewSigma : Instant{});
        return;
    }
    std::vector<Frame> best;
    for (std::size_t part = 0; part < kParts; ++part) {
        const Instant from = first + span * static_cast<Instant::rep>(part) / static_cast<Instant::rep>(kParts),
                      to = first + span * static_cast<Instant::rep>(part + 1) / static_cast<Instant::rep>(kParts);
        const Frame* quickest = nullptr;
        for (const Frame& frame : frames_)
            if (frame.by_device >= from && frame.by_device <= to && (!quickest || frame.late < quickest->late))
                quickest = &frame;
        if (quickest) best.push_back(*quickest);
    }
    // A part without a quick frame (the computer was busy) lies above the line: of all lines through two of them, the
    // one under all, as near to them as it can be.
    double least = -1;
    for (std::size_t i = 0; i < best.size(); ++i)
        for (std::size_t j = i + 1; j < best.size(); ++j) {
            const double slope = seconds(best[j].late - best[i].late) / seconds(best[j].by_device - best[i].by_device);
            if (!(std::abs(slope) <= settings_.largest_drift)) continue;
            double above = 0;
            bool under = true;
            for (const Frame& frame : best) {
                const double off =
                    seconds(frame.late - best[i].late) - slope * seconds(frame.by_device - best[i].by_device);
                under = under && off > -1e-6;
                above += off;
            }
            if (!under || (least >= 0 && above >= least)) continue;
            least = above;
            origin_ = best[i].by_device;
            offset_ = best[i].late;
            drift_ = slope;
        }
    if (least < 0) {
        const Frame& lowest = *std::min_element(best.begin(), best.end(), quicker);
        origin_ = lowest.by_device;
        offset_ = lowest.late;
        drift_ = 0;
        least = static_cast<double>(best.size()) * seconds(scaled(span, settings_.largest_drift));
    }
    sigma_ = kArrivalNoise + from_seconds(least / static_cast<double>(std::max<std::size_t>(best.size(), 1)) / 2);
}

Instant DeviceClock::on_session_clock(Instant by_device) const {
    return by_device + offset_ + scaled(by_device - origin_, drift_);
}

}  // namespace planlight
