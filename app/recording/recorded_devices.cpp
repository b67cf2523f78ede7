#include "app/recording/recorded_devices.h"

#include <fmt/format.h>

#include "planning_io/recording/packed_pictures.h"
#include "planning_io/types/error.h"

namespace planlight {

using Kind = RecordedInput::Kind;

namespace {

constexpr const char* kAsked[] = {"",
                                  "the time",
                                  "a picture to be shown",
                                  "darkness",
                                  "a frame",
                                  "a device (which failed)",
                                  "to go on with a scan (which was stopped)",
                                  "what the cameras say of themselves",
                                  "the end of an exposure"};

/// As it was thrown then: "Left camera: it sends nothing".
DeviceError failed(const RecordedInput& input) {
    const auto colon = input.text.find(": ");
    if (colon == std::string::npos) return {"Device", input.text, input.remedy};
    return {input.text.substr(0, colon), input.text.substr(colon + 2), input.remedy};
}

}  // namespace

std::string words_of(const RecordingCursor::Next& next) {
    constexpr std::size_t kLong = 120;
    if (next.event) return "what came of it: " + next.event->substr(0, kLong);
    return kAsked[static_cast<std::size_t>(next.input->kind)];
}

RecordedInput RecordedDevices::answer(Kind kind) const {
    const auto next = cursor_.take();
    if (next.input && next.input->kind == Kind::failed) throw failed(*next.input);
    if (next.input && next.input->kind == kind) return *next.input;
    throw ReplayDiffers{fmt::format("the order of things: the session now asks for {}, where the recording has {}",
                                    kAsked[static_cast<std::size_t>(kind)], words_of(next))};
}

Instant RecordedDevices::show(const RgbImage& picture, Instant valid_until) {
    const RecordedInput input = answer(Kind::shown);
    if (input.text != hash_of(picture)) throw ReplayDiffers{"the picture that was handed to the projector"};
    if (input.until != valid_until)
        throw ReplayDiffers{fmt::format("how long a picture was to be shown: {} ns recorded, {} ns now",
                                        input.until.count(), valid_until.count())};
    ++given_.pictures;
    return input.at;
}

void RecordedDevices::go_dark() noexcept {
    try {
        if (const auto& next = cursor_.peek(); next.input && next.input->kind == Kind::dark) cursor_.take();
    } catch (...) {
    }
}

StereoFrame RecordedDevices::grab(Instant, std::chrono::milliseconds) {
    StereoFrame frame = cursor_.frame(answer(Kind::frame));
    if (given_.frames++ == 0) given_.first_at = frame.at;
    given_.last_number = frame.number, given_.last_at = frame.at;
    return frame;
}

/// Recorded where it could be told.
bool RecordedDevices::wait_until_exposed(Instant, std::chrono::milliseconds) {
    const auto& next = cursor_.peek();
    if (!next.input || next.input->kind != Kind::exposed) return false;
    cursor_.take();
    return true;
}

/// Recorded where it changed.
std::string RecordedDevices::doubt() const {
    if (const auto& next = cursor_.peek(); next.input && next.input->kind == Kind::doubt)
        doubt_ = cursor_.take().input->text;
    return doubt_;
}

Instant RecordedDevices::now() const {
    return answer(Kind::clock).at;
}

void RecordedDevices::stop_if_stopped() {
    const auto& next = cursor_.peek();
    if (!next.input || next.input->kind != Kind::stopped) return;
    const RecordedInput input = *cursor_.take().input;
    throw CheckFailedError(input.text, input.remedy);
}

}  // namespace planlight
