#include "registration/devices/camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace planlight {

CameraFault sends_one_picture(std::int64_t for_ms) {
    return {fmt::format("for {} ms it has sent one picture again and again, under new times", for_ms),
            "Take out of its pipeline what repeats pictures (`videorate`), or switch it off and on again."};
}

void FrameBell::ring() {
    {
        const std::lock_guard lock(mutex);
        ++rings;
    }
    rung.notify_all();
}

void FrameQueue::push(CameraFrame frame) {
    {
        const std::lock_guard lock(mutex_);
        ++counts_.received;
        note_whole(true);
        if (frames_.size() == kMost) {
            frames_.pop_front();
            ++counts_.dropped;
        }
        frames_.push_back(std::move(frame));
    }
    bell_.ring();
}

void FrameQueue::count_incomplete() {
    const std::lock_guard lock(mutex_);
    ++counts_.incomplete;
    note_whole(false);
}

void FrameQueue::count_repeated() {
    const std::lock_guard lock(mutex_);
    ++counts_.repeated;
}

void FrameQueue::note_whole(bool whole) {
    constexpr std::size_t kLately = 25;
    lately_whole_.push_back(whole);
    if (lately_whole_.size() > kLately) lately_whole_.pop_front();
    counts_.lately = lately_whole_.size();
    counts_.lately_incomplete = static_cast<std::size_t>(std::count(lately_whole_.begin(), lately_whole_.end(), false));
}

void FrameQueue::note_clock(double drift, Instant sigma, Instant behind) {
    const std::lock_guard lock(mutex_);
    counts_.own_clock = true;
    counts_.clock_drift = drift;
    counts_.clock_sigma = sigma;
    counts_.behind = behind;
}

void FrameQueue::count_jump() {
    const std::lock_guard lock(mutex_);
    ++counts_.clock_jumps;
}

void FrameQueue::fail(CameraFault fault) {
    {
        const std::lock_guard lock(mutex_);
        if (!fault_) ++counts_.lost_connections;
        fault_ = std::move(fault);
        frames_.clear();
    }
    bell_.ring();
}

void FrameQueue::recovered() {
    const std::lock_guard lock(mutex_);
    fault_.reset();
}

std::vector<CameraFrame> FrameQueue::take_all() {
    const std::lock_guard lock(mutex_);
    std::vector<CameraFrame> taken(std::make_move_iterator(frames_.begin()), std::make_move_iterator(frames_.end()));
    frames_.clear();
    return taken;
}

bool FrameQueue::waiting() const {
    const std::lock_guard lock(mutex_);
    return !frames_.empty();
}

std::optional<CameraFault> FrameQueue::fault() const {
    const std::lock_guard lock(mutex_);
    return fault_;
}

CameraCounts FrameQueue::counts() const {
    const std::lock_guard lock(mutex_);
    return counts_;
}

}  // namespace planlight
