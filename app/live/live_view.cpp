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

void LiveView::expect_found(bool expect) {
    const std::lock_guard lock(mutex_);
    expect_found_ = expect;
}

void LiveView::take(const StereoFrame& frame) {
    const Instant now = clock_.now();
    {
        const std::lock_guard lock(mutex_);
        if (next_.left.picture && now - next_.taken < kShortest) return;
    }
    Pair pair{{std::make_shared<GrayImage>(frame.left), {}, false},
              {std::make_shared<GrayImage>(frame.right), {}, false},
              frame.at,
              now};
    const std::lock_guard lock(mutex_);
    next_ = std::move(pair);
    if (!expect_found_) shown_ = next_;
    left_note_.clear();
    right_note_.clear();
}

void LiveView::found(Instant at, std::vector<FoundMarker> left, std::vector<FoundMarker> right) {
    const std::lock_guard lock(mutex_);
    if (at != next_.at || !next_.left.picture) return;
    next_.left.found = std::move(left);
    next_.right.found = std::move(right);
    next_.left.searched = next_.right.searched = true;
    shown_ = next_;
}

void LiveView::failed(const std::string& why) {
    const std::lock_guard lock(mutex_);
    const bool left = why.starts_with("Left"), right = why.starts_with("Right");
    if (left || !right) left_note_ = why;
    if (right || !left) right_note_ = why;
}

void LiveView::put_into(OperatorModel& model) const {
    const std::lock_guard lock(mutex_);
    if (!shown_.left.picture) return;
    const Instant age = clock_.now() - shown_.taken;
    const int old_s = age < old_after_ ? 0 : std::max(1, static_cast<int>(seconds(age)));
    model.left.live = shown_.left;
    model.right.live = shown_.right;
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
