#include "registration/devices/paired_cameras.h"

#include <fmt/format.h>

#include <algorithm>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

/// The earliest that its exposure can have begun, as far as its camera's clock is known.
Instant begin_of(const CameraFrame& frame) {
    return frame.at - frame.exposure / 2 - 2 * frame.at_sigma;
}

void append(std::deque<CameraFrame>& to, std::vector<CameraFrame> frames) {
    for (CameraFrame& frame : frames) to.push_back(std::move(frame));
    while (to.size() > FrameQueue::kMost) to.pop_front();
}

}  // namespace

Instant allowed_apart(const PairSettings& settings, Instant exposure, Instant interval) {
    constexpr Instant kMostTogether = std::chrono::milliseconds(10);
    if (settings.together && interval > Instant{}) return std::min(kMostTogether, interval / 3);
    return std::max(settings.least_apart,
                    std::min(settings.most_apart, from_seconds(settings.apart_of_exposure * seconds(exposure))));
}

PairedCameras::PairedCameras(std::unique_ptr<Camera> left, std::unique_ptr<Camera> right, FrameBell& bell,
                             const Clock& clock, const PairSettings& settings)
    : left_(std::move(left)), right_(std::move(right)), bell_(bell), clock_(clock), settings_(settings) {}

StereoFrame PairedCameras::grab(Instant not_before, std::chrono::milliseconds patience) {
    return wait_for_pair(not_before, patience, false);
}

StereoFrame PairedCameras::newest(Instant not_before, std::chrono::milliseconds patience) {
    return wait_for_pair(not_before, patience, true);
}

void PairedCameras::collect() {
    std::vector<CameraFrame> left = left_->frames().take_all(), right = right_->frames().take_all();
    lefts_seen_ += left.size();
    for (const CameraFrame& frame : right) right_times_.add(frame);
    for (const CameraFrame& frame : left) {
        left_times_.add(frame);
        const Instant since = frame.at - last_left_;
        if (last_left_ > Instant{} && since > Instant{})
            interval_ = interval_ == Instant{} ? since : std::min(since, interval_ + interval_ / 8);
        last_left_ = frame.at;
    }
    rights_seen_ += right.size();
    append(lefts_, std::move(left));
    append(rights_, std::move(right));
}

/// The earliest pair that begins at or after a moment; frames that can no longer have a partner are left behind.
std::optional<StereoFrame> PairedCameras::next_pair(Instant not_before) {
    while (!lefts_.empty() && begin_of(lefts_.front()) < not_before) lefts_.pop_front();
    while (!rights_.empty() && begin_of(rights_.front()) < not_before) rights_.pop_front();
    while (!lefts_.empty() && !rights_.empty()) {
        CameraFrame &left = lefts_.front(), &right = rights_.front();
        const Instant allowed = counts_.allowed =
            allowed_apart(settings_, std::min(left.exposure, right.exposure), interval_);
        counts_.apart = right.at - left.at;
        const Instant apart_now = std::max(counts_.apart, -counts_.apart);
        nearest_ = nearest_ ? std::min(*nearest_, apart_now) : apart_now;
        if (counts_.apart > allowed) {
            ++counts_.left_alone;
            lefts_.pop_front();
            continue;
        }
        if (counts_.apart < -allowed) {
            ++counts_.right_alone;
            rights_.pop_front();
            continue;
        }
        StereoFrame pair;
        pair.at = left.at + counts_.apart / 2;
        // Of what is not together by wire the light must be steady from the first to open to the last to close.
        const Instant apart = settings_.together ? Instant{} : apart_now;
        pair.exposure = std::max(left.exposure, right.exposure) + apart;
        pair.number = ++counts_.pairs;
        pair.left = std::move(left.picture);
        pair.right = std::move(right.picture);
        lefts_.pop_front();
        rights_.pop_front();
        return pair;
    }
    return std::nullopt;
}

void PairedCameras::refuse(std::chrono::milliseconds patience) const {
    struct Side {
        Camera* camera;
        std::size_t seen, incomplete;
    };
    const Side sides[] = {{left_.get(), lefts_seen_, left_->frames().counts().incomplete - left_incomplete_},
                          {right_.get(), rights_seen_, right_->frames().counts().incomplete - right_incomplete_}};
    for (const Side& side : sides)
        if (side.seen == 0 && side.incomplete == 0)
            throw DeviceError(side.camera->name(), fmt::format("no frame came in {} ms", patience.count()),
                              "Look at its cable and its power, and whether its trigger runs.");
    const Side& worse = sides[0].incomplete >= sides[1].incomplete ? sides[0] : sides[1];
    if (worse.incomplete > worse.seen)
        throw DeviceError(worse.camera->name(),
                          fmt::format("of its frames {} came whole in {} ms, and {} with packets lost", worse.seen,
                                      patience.count(), worse.incomplete),
                          "Look at the network: its receive buffer (net.core.rmem_max), jumbo frames, other traffic.");
    for (const Side& side : sides)
        if (const Instant behind = side.camera->frames().counts().behind; behind > Instant{})
            throw DeviceError(side.camera->name(),
                              fmt::format("its pictures come {:.0f} ms late", 1e3 * seconds(behind)),
                              "Switch that camera off and on, and look at its network for other traffic.");
    if (!nearest_)
        throw DeviceError("Cameras", fmt::format("no pair was exposed after the light in {} ms", patience.count()),
                          "Raise the frame rate of both, and look at the network for other traffic.");
    throw DeviceError(
        "Cameras",
        fmt::format("the two do not expose together: their nearest exposures are {:.1f} ms apart",
                    1e3 * seconds(*nearest_)),
        "Let one camera trigger the other, or both by one line, and give both the same exposure. If they do expose "
        "together, one's pictures travel longer: give that camera so much more \"transfer_ms\" in room.json.");
}

std::string PairedCameras::doubt() const {
    constexpr std::size_t kMany = 3;
    for (Camera* camera : {left_.get(), right_.get()}) {
        const CameraCounts counts = camera->frames().counts();
        if (counts.behind > Instant{})
            return fmt::format("{}: its pictures come {:.0f} ms late", camera->name(), 1e3 * seconds(counts.behind));
        if (counts.lately_incomplete >= kMany)
            return fmt::format("{}: {} of its last {} frames lost packets", camera->name(), counts.lately_incomplete,
                               counts.lately);
    }
    return {};
}

/// When both shutters have surely closed on the first pair that begins at or after a moment; empty: not known.
std::optional<Instant> PairedCameras::closing_of_pair(Instant not_before) const {
    const auto left = left_times_.first_after(not_before), right = right_times_.first_after(not_before);
    if (!left || !right) return std::nullopt;
    const Instant allowed = allowed_apart(settings_, std::min(left->exposure, right->exposure), interval_);
    // Where one of them begins before that moment and its partner after, both wait for the next.
    const Instant apart = right->at - left->at;
    const ExposureTimes::Expected* later = apart > Instant{} ? &*right : &*left;
    if (apart >= -allowed && apart <= allowed) return std::max(left->closed, right->closed);
    return later->closed + allowed;
}

bool PairedCameras::wait_until_exposed(Instant not_before, std::chrono::milliseconds patience) {
    if (!left_->global_shutter() || !right_->global_shutter()) return false;
    const Instant until = clock_.now() + patience;
    for (;;) {
        collect();
        const auto closing = closing_of_pair(not_before);
        if (!closing || *closing > until || left_->frames().fault() || right_->frames().fault()) return false;
        const Instant now = clock_.now();
        if (now >= *closing) return true;
        // A frame that comes meanwhile tells it better.
        std::unique_lock lock(bell_.mutex);
        bell_.rung.wait_for(lock, std::min(*closing - now, Instant(std::chrono::milliseconds(20))),
                            [&, rings = bell_.rings] { return bell_.rings != rings; });
    }
}

StereoFrame PairedCameras::wait_for_pair(Instant not_before, std::chrono::milliseconds patience, bool newest) {
    const Instant until = clock_.now() + patience;
    lefts_seen_ = rights_seen_ = 0;
    nearest_.reset();
    left_incomplete_ = left_->frames().counts().incomplete;
    right_incomplete_ = right_->frames().counts().incomplete;
    for (;;) {
        std::uint64_t rings = 0;
        {
            const std::lock_guard lock(bell_.mutex);
            rings = bell_.rings;
        }
        for (Camera* camera : {left_.get(), right_.get()})
            if (const auto fault = camera->frames().fault())
                throw DeviceError(camera->name(), fault->problem, fault->remedy);
        collect();
        auto pair = next_pair(not_before);
        if (pair && newest)
            while (auto later = next_pair(not_before)) pair = std::move(later);
        if (pair) return std::move(*pair);
        const Instant now = clock_.now();
        if (now >= until) refuse(patience);
        std::unique_lock lock(bell_.mutex);
        bell_.rung.wait_for(lock, std::min(until - now, Instant(std::chrono::milliseconds(20))),
                            [&] { return bell_.rings != rings; });
    }
}

}  // namespace planlight
