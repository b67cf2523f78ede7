#include "app/live/camera_watch.h"

#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>

#include "planning_io/types/statistics.h"
#include "registration/devices/focus_measure.h"

namespace planlight {
namespace {

constexpr Instant kRateOver = std::chrono::seconds(2);

/// Frames a second over the moments that are kept; 0 where it is too early to tell.
double rate_of(const std::deque<std::pair<Instant, std::size_t>>& counts) {
    if (counts.size() < 2) return 0;
    const double over_s = seconds(counts.back().first - counts.front().first);
    return over_s > 0 ? static_cast<double>(counts.back().second - counts.front().second) / over_s : 0;
}

}  // namespace

CameraWatch::CameraWatch(Camera& left, Camera& right, const Clock& clock, const PairSettings& pairs,
                         const MarkerSettings& markers)
    : clock_(clock), pairs_(pairs), markers_(markers), left_{&left, {}, {}}, right_{&right, {}, {}} {
    for (auto [side, watched] : {std::pair{&left_, &now_.left}, std::pair{&right_, &now_.right}}) {
        watched->name = side->camera->name();
        watched->width = side->camera->width();
        watched->height = side->camera->height();
        watched->notes = side->camera->notes();
    }
    state_ = now_;
}

std::vector<CameraFrame> CameraWatch::take(Side& side, WatchedCamera& watched) {
    std::vector<CameraFrame> frames = side.camera->frames().take_all();
    const CameraCounts counts = side.camera->frames().counts();
    const Instant now = clock_.now();
    side.counts.emplace_back(now, counts.received);
    while (side.counts.size() > 2 && now - side.counts.front().first > kRateOver) side.counts.pop_front();
    for (std::size_t i = 1; i < frames.size(); ++i) {
        const Instant step = frames[i].at - frames[i - 1].at;
        side.interval = side.interval == Instant{} ? step : std::min(step, side.interval + side.interval / 8);
    }
    watched.frames_hz = rate_of(side.counts);
    watched.received = counts.received;
    watched.lost = counts.incomplete;
    watched.repeated = counts.repeated;
    watched.fault = side.camera->frames().fault();
    watched.notes = side.camera->notes();
    return frames;
}

void CameraWatch::measure(const CameraFrame& newest, WatchedCamera& watched) const {
    watched.picture = std::make_shared<const GrayImage>(newest.picture);
    watched.exposure_ms = 1e3 * seconds(newest.exposure);
    watched.markers = find_markers(newest.picture, markers_);
    watched.clipped = clipped_shares(newest.picture);
    watched.sharpness = focus_measure(newest.picture);
    watched.best_sharpness = std::max(watched.best_sharpness, watched.sharpness);
}

/// Of all frames that came the two that are nearest to each other: what came alone has its partner still on its way.
void CameraWatch::note_apart(const std::vector<CameraFrame>& lefts, const std::vector<CameraFrame>& rights) {
    constexpr std::size_t kLooks = 15;
    std::optional<Instant> nearest;
    for (const CameraFrame& left : lefts)
        for (const CameraFrame& right : rights) {
            const Instant apart = right.at - left.at;
            if (nearest && std::abs(apart.count()) >= std::abs(nearest->count())) continue;
            nearest = apart;
            now_.allowed_ms =
                1e3 * seconds(allowed_apart(pairs_, std::min(left.exposure, right.exposure), left_.interval));
        }
    if (!nearest) return;
    apart_ms_.push_back(1e3 * seconds(*nearest));
    if (apart_ms_.size() > kLooks) apart_ms_.pop_front();
    now_.apart_ms = median(std::vector<double>(apart_ms_.begin(), apart_ms_.end()));
}

void CameraWatch::look() {
    {
        const std::lock_guard lock(mutex_);
        if (std::exchange(forget_, false)) now_.left.best_sharpness = now_.right.best_sharpness = 0;
    }
    const std::vector<CameraFrame> lefts = take(left_, now_.left), rights = take(right_, now_.right);
    note_apart(lefts, rights);
    if (!lefts.empty()) measure(lefts.back(), now_.left);
    if (!rights.empty()) measure(rights.back(), now_.right);
    const std::lock_guard lock(mutex_);
    state_ = now_;
}

void CameraWatch::run(const std::stop_token& stop) {
    constexpr auto kPause = std::chrono::milliseconds(10);
    for (; !stop.stop_requested(); std::this_thread::sleep_for(kPause)) look();
}

WatchedRoom CameraWatch::state() const {
    const std::lock_guard lock(mutex_);
    return state_;
}

void CameraWatch::forget_best() {
    const std::lock_guard lock(mutex_);
    forget_ = true;
}

}  // namespace planlight
