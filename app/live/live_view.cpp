#include "app/live/live_view.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace planlight {
namespace {

constexpr Instant kShortest = std::chrono::milliseconds(45);
constexpr int kAcross = 32, kDown = 24;  // blocks in which two pictures are compared
constexpr double kSameGrey = 2.5;        // grey values of a block's mean: noise is far less, a finger far more
constexpr double kSamePlace_px = 1.5;    // of a marker

/// The mean of every block, from every third pixel of it.
std::vector<double> block_means(const GrayImage& picture) {
    std::vector<double> means;
    for (int row = 0; row < kDown; ++row)
        for (int column = 0; column < kAcross; ++column) {
            double sum = 0, count = 0;
            for (int y = row * picture.height / kDown; y < (row + 1) * picture.height / kDown; y += 3)
                for (int x = column * picture.width / kAcross; x < (column + 1) * picture.width / kAcross; x += 3)
                    sum += picture.at(x, y), ++count;
            means.push_back(count > 0 ? sum / count : 0);
        }
    return means;
}

/// A person would not see the difference: then the window need not be drawn again for it.
bool alike(const SeenPicture& a, const SeenPicture& b) {
    if (!a.picture || !b.picture || a.picture->width != b.picture->width || a.picture->height != b.picture->height)
        return false;
    if (a.searched != b.searched || a.found.size() != b.found.size()) return false;
    for (const FoundMarker& one : a.found)
        if (std::none_of(b.found.begin(), b.found.end(), [&](const FoundMarker& other) {
                return (other.pixel - one.pixel).norm() < kSamePlace_px && other.pairing == one.pairing;
            }))
            return false;
    const std::vector<double> of_a = block_means(*a.picture), of_b = block_means(*b.picture);
    for (std::size_t i = 0; i < of_a.size(); ++i)
        if (std::abs(of_a[i] - of_b[i]) > kSameGrey) return false;
    return true;
}

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
    if (alike(next_.left, shown_.left) && alike(next_.right, shown_.right))
        shown_.taken = next_.taken;  // it is as live as the new one
    else
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
    if (!left_note_.empty()) model.left.note = left_note_;
    if (!right_note_.empty()) model.right.note = right_note_;
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
