#include "app/live/live_view.h"

#include <algorithm>
#include <memory>
#include <utility>

namespace planlight {
namespace {

constexpr Instant kShortest = std::chrono::milliseconds(45);

}  // namespace

void LiveView::set_old_after(Instant old_after) {
    const std::lock_guard lock(mutex_);
    old_after_ = old_after;
}

void LiveView::take(const StereoFrame& frame) {
    const Instant now = clock_.now();
    {
        const std::lock_guard lock(mutex_);
        if (left_.picture && now - taken_ < kShortest) return;
    }
    SeenPicture left{std::make_shared<GrayImage>(frame.left), {}, false},
        right{std::make_shared<GrayImage>(frame.right), {}, false};
    const std::lock_guard lock(mutex_);
    left_ = std::move(left);
    right_ = std::move(right);
    at_ = frame.at;
    taken_ = now;
    left_note_.clear();
    right_note_.clear();
}

void LiveView::found(Instant at, std::vector<FoundMarker> left, std::vector<FoundMarker> right) {
    const std::lock_guard lock(mutex_);
    if (at != at_) return;
    left_.found = std::move(left);
    right_.found = std::move(right);
    left_.searched = right_.searched = true;
}

void LiveView::failed(const std::string& why) {
    const std::lock_guard lock(mutex_);
    const bool left = why.starts_with("Left"), right = why.starts_with("Right");
    if (left || !right) left_note_ = why;
    if (right || !left) right_note_ = why;
}

void LiveView::put_into(OperatorModel& model) const {
    const std::lock_guard lock(mutex_);
    if (!left_.picture) return;
    const Instant age = clock_.now() - taken_;
    const int old_s = age < old_after_ ? 0 : std::max(1, static_cast<int>(seconds(age)));
    model.left.live = left_;
    model.right.live = right_;
    model.left.old_s = model.right.old_s = old_s;
    model.left.note = left_note_;
    model.right.note = right_note_;
}

StereoFrame CameraTap::grab(Instant not_before, std::chrono::milliseconds patience) {
    StereoFrame frame = cameras_.grab(not_before, patience);
    view_.take(frame);
    return frame;
}

StereoFrame CameraTap::newest(Instant not_before, std::chrono::milliseconds patience) {
    StereoFrame frame = cameras_.newest(not_before, patience);
    view_.take(frame);
    return frame;
}

}  // namespace planlight
