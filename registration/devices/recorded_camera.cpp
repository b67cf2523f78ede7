#include "registration/devices/recorded_camera.h"

#include <fmt/format.h>

#include <utility>

namespace planlight {

std::uint64_t play_into(FrameQueue& queue, RecordedPlay& play, const std::vector<GrayImage>& pictures,
                        std::uint64_t after, Instant now) {
    if (play.pace() == RecordedPace::fastest && queue.waiting()) return after;
    for (const RecordedPlay::Exposure& one : play.due(after, now, FrameQueue::kMost)) {
        for (std::size_t i = 0; i < one.lost; ++i) queue.count_incomplete();
        queue.push({pictures[one.picture], one.at, one.exposure, {}});
        after = one.number;
    }
    return after;
}

RecordedCamera::RecordedCamera(RecordedSettings settings, std::vector<GrayImage> pictures,
                               std::shared_ptr<RecordedPlay> play, FrameBell& bell, const Clock& clock)
    : settings_(std::move(settings)),
      pictures_(std::move(pictures)),
      play_(std::move(play)),
      clock_(clock),
      frames_(bell),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

RecordedCamera::~RecordedCamera() {
    thread_.request_stop();
    thread_.join();
}

std::vector<std::string> RecordedCamera::notes() const {
    return {fmt::format("No camera looks: it plays the recording \"{}\"", settings_.from)};
}

void RecordedCamera::run(const std::stop_token& stop) {
    constexpr auto kPoll = std::chrono::milliseconds(1);
    for (std::uint64_t last = 0; !stop.stop_requested(); std::this_thread::sleep_for(kPoll))
        last = play_into(frames_, *play_, pictures_, last, clock_.now());
}

}  // namespace planlight
