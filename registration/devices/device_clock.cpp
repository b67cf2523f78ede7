#include "registration/devices/device_clock.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace planlight {
namespace {

constexpr std::size_t kParts = 8;       // of the window, the quickest frame of each makes the line
constexpr std::size_t kFewFrames = 20;  // of fewer the quickest may still have come late
constexpr Instant kFewSigma{5'000'000};
constexpr Instant kArrivalNoise{100'000};  // of the quickest arrivals, one standard deviation

Instant scaled(Instant t, double factor) {
    return Instant(static_cast<Instant::rep>(std::llround(static_cast<double>(t.count()) * factor)));
}

}  // namespace

DeviceClock::DeviceClock(const DeviceClockSettings& settings) : settings_(settings) {}

Instant DeviceClock::span() const {
    return known() ? frames_.back().by_device - frames_.front().by_device : Instant{};
}

/// Whether this frame's time lies a whole number of usual steps after the last one's.
bool DeviceClock::steps_evenly(Instant by_device) {
    const Instant step = by_device - last_by_device_;
    const bool first = last_by_device_ < Instant{};
    last_by_device_ = by_device;
    if (first || step <= Instant{}) return false;
    if (usual_step_ == Instant{}) {
        usual_step_ = step;
        return false;
    }
    const auto steps = std::max<Instant::rep>(1, (step + usual_step_ / 2) / usual_step_);
    const Instant off = step - steps * usual_step_;
    const bool even = std::max(off, -off) < usual_step_ / 8;
    if (even && steps == 1) usual_step_ += off / 8;
    if (!even && even_steps_ == 0) usual_step_ = std::min(step, usual_step_ + usual_step_ / 8);
    return even;
}

/// Whether what is late becomes later all the time: a camera that is behind stays so far behind, a clock that runs slow
/// does not. By the quickest frame of each second.
bool DeviceClock::lateness_grows(Instant by_device, Instant off) {
    constexpr Instant kBlock = std::chrono::seconds(1), kGrows = std::chrono::milliseconds(3);
    block_least_ = std::min(block_least_, off);
    if (by_device - block_since_ < kBlock) return growing_blocks_ >= 2;
    const bool grows = last_block_least_ > Instant{} && block_least_ - last_block_least_ > kGrows;
    growing_blocks_ = grows ? growing_blocks_ + 1 : 0;
    last_block_least_ = block_least_;
    block_least_ = off;
    block_since_ = by_device;
    return growing_blocks_ >= 2;
}

/// Whether the clock was set, by a frame that came `off` later than it should.
bool DeviceClock::was_set(Instant by_device, Instant off) {
    constexpr int kEven = 20;  // in a row: its times can be judged by their steps
    const bool late = off > settings_.largest_jump, judged = even_steps_ >= kEven;
    const bool even = steps_evenly(by_device);
    even_steps_ = even ? even_steps_ + 1 : 0;
    if (off < -settings_.largest_jump) return true;  // earlier than any frame can be
    if (!late) {
        late_since_ = Instant(-1);
        late_in_a_row_ = 0;
        behind_ = false;
        return false;
    }
    const bool first = late_since_ < Instant{};
    if (first) {
        late_since_ = by_device;
        least_late_ = block_least_ = off;
        last_block_least_ = {};
        block_since_ = by_device;
        growing_blocks_ = 0;
        behind_ = judged && even && off - last_off_ > settings_.largest_jump / 2;
    }
    ++late_in_a_row_;
    least_late_ = std::min(least_late_, off);
    if (judged && !even) return true;
    if (behind_ && lateness_grows(by_device, off)) behind_ = false;
    return !behind_ && by_device - late_since_ > settings_.late_for;
}

void DeviceClock::begin_anew(Instant off) {
    frames_.clear();
    late_since_ = last_by_device_ = Instant(-1);
    late_in_a_row_ = even_steps_ = 0;
    usual_step_ = {};
    behind_ = false;
    drift_ = runs_wrong_ = 0;
    ++jumps_;
    last_jump_ = -off;
}

bool DeviceClock::add(Instant by_device, Instant arrived) {
    bool steady = true;
    Instant off{};
    if (known()) {
        off = arrived - on_session_clock(by_device);
        const bool backwards = by_device < frames_.back().by_device;
        const bool learning = frames_.size() < kFewFrames && !backwards;
        if (was_set(by_device, off) || backwards) {
            if (even_steps_ == 0 || backwards) recent_.clear();  // it was set, and does not just run otherwise
            begin_anew(off);
            if (learning)  // the first frames came late, that is all
                --jumps_;
            else
                steady = false;
        } else if (off > settings_.largest_jump) {
            last_off_ = off;
            judge_run(by_device, arrived);
            return true;  // it tells nothing of the clock
        }
    }
    last_off_ = off;
    frames_.push_back({by_device, arrived - by_device});
    while (by_device - frames_.front().by_device > settings_.window) frames_.pop_front();
    fit();
    judge_run(by_device, arrived);
    return steady;
}

/// The trend of the quickest frames of the last seconds: a straight line that is surely steeper than any clock runs.
void DeviceClock::judge_run(Instant by_device, Instant arrived) {
    constexpr double kSure = 6, kBeyond = 4;  // standard deviations; times the largest drift
    const Instant over = settings_.drift_known_after, first = by_device - over;
    recent_.push_back({by_device, arrived - by_device});
    runs_wrong_ = 0;
    if (recent_.front().by_device > first) return;
    while (recent_[1].by_device <= first) recent_.pop_front();  // a gap of lost frames must not acquit it
    std::vector<double> x, y;
    Instant part_ends{};
    for (const Frame& frame : recent_) {
        if (x.empty() || frame.by_device >= part_ends) {
            part_ends = frame.by_device + over / static_cast<Instant::rep>(kParts);
            x.push_back(seconds(frame.by_device - first));
            y.push_back(seconds(frame.late));
        } else if (seconds(frame.late) < y.back()) {
            x.back() = seconds(frame.by_device - first);
            y.back() = seconds(frame.late);
        }
    }
    if (x.size() < kParts / 2 + 1) return;
    const auto n = static_cast<double>(x.size());
    double mean_x = 0, mean_y = 0, xx = 0, xy = 0, rest = 0;
    for (std::size_t i = 0; i < x.size(); ++i) mean_x += x[i] / n, mean_y += y[i] / n;
    for (std::size_t i = 0; i < x.size(); ++i) {
        xx += (x[i] - mean_x) * (x[i] - mean_x);
        xy += (x[i] - mean_x) * (y[i] - mean_y);
    }
    const double slope = xy / xx;
    for (std::size_t i = 0; i < x.size(); ++i) rest += std::pow(y[i] - mean_y - slope * (x[i] - mean_x), 2);
    const double sigma = std::sqrt(rest / (n - 2) / xx);
    if (std::abs(slope) - kSure * sigma > kBeyond * settings_.largest_drift) runs_wrong_ = -slope;
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
