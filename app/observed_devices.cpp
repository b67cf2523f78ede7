#include "app/observed_devices.h"

#include "app/session_observer.h"

namespace planlight {
namespace {

template <class Ask>
auto asked(SessionObserver* observer, Ask ask) {
    try {
        return ask();
    } catch (const Error& fault) {
        if (observer) observer->device_failed(fault);
        throw;
    }
}

}  // namespace

Instant ObservedDevices::ObservedProjector::show(const RgbImage& picture, Instant valid_until) {
    const Instant lit_from = asked(observer_, [&] { return device_.show(picture, valid_until); });
    if (observer_) observer_->picture_shown(picture, valid_until, lit_from);
    return lit_from;
}

void ObservedDevices::ObservedProjector::go_dark() noexcept {
    device_.go_dark();
    if (observer_) observer_->went_dark();
}

StereoFrame ObservedDevices::ObservedCameras::grab(Instant not_before, std::chrono::milliseconds patience) {
    StereoFrame frame = asked(observer_, [&] { return device_.grab(not_before, patience); });
    if (observer_) observer_->frame_taken(frame);
    return frame;
}

StereoFrame ObservedDevices::ObservedCameras::newest(Instant not_before, std::chrono::milliseconds patience) {
    StereoFrame frame = asked(observer_, [&] { return device_.newest(not_before, patience); });
    if (observer_) observer_->frame_taken(frame);
    return frame;
}

bool ObservedDevices::ObservedCameras::wait_until_exposed(Instant not_before, std::chrono::milliseconds patience) {
    const bool exposed = asked(observer_, [&] { return device_.wait_until_exposed(not_before, patience); });
    if (exposed && observer_) observer_->frame_exposed();
    return exposed;
}

std::string ObservedDevices::ObservedCameras::doubt() const {
    std::string doubt = device_.doubt();
    if (observer_ && doubt != told_doubt_) observer_->cameras_doubted(doubt);
    told_doubt_ = doubt;
    return doubt;
}

Instant ObservedDevices::ObservedClock::now() const {
    const Instant now = device_.now();
    if (observer_) observer_->clock_read(now);
    return now;
}

}  // namespace planlight
