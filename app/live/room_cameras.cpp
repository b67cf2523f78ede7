#include "app/live/room_cameras.h"

#include <algorithm>

#include "planning_io/case/light_file.h"
#include "planning_io/types/error.h"
#include "registration/devices/genicam_camera.h"
#include "registration/devices/gstreamer_camera.h"

namespace planlight {
namespace {

ProjectorKeeperSettings settings_of(const std::filesystem::path& projector_file) {
    ProjectorKeeperSettings settings;
    if (projector_file.empty()) return settings;
    const ProjectorFacts facts = read_projector_file(projector_file);
    settings.process.light_delay = facts.light_delay.value_or(settings.process.light_delay);
    return settings;
}

GenicamSettings genicam_settings(const RoomCamera& camera, const std::string& name) {
    GenicamSettings settings;
    settings.name = name;
    settings.device = camera.device;
    settings.line = camera.line;
    settings.pixel_format = camera.pixel_format;
    settings.exposure_ms = camera.exposure_ms;
    settings.gain = camera.gain;
    settings.frames_hz = camera.frames_hz;
    settings.region = camera.region;
    settings.transfer_ms = camera.transfer_ms;
    return settings;
}

std::unique_ptr<Camera> opened(const RoomCamera& camera, const std::string& name, FrameBell& bell, const Clock& clock) {
    if (camera.pipeline.empty()) return std::make_unique<GenicamCamera>(genicam_settings(camera, name), bell, clock);
    GstreamerSettings settings;
    settings.name = name;
    settings.pipeline = camera.pipeline;
    settings.exposure_ms = camera.exposure_ms.value_or(settings.exposure_ms);
    settings.stamped_late_ms = camera.transfer_ms.value_or(0);
    return std::make_unique<GstreamerCamera>(settings, bell, clock);
}

}  // namespace

RoomCameras::RoomCameras(const RoomFile& room, const Clock& clock,
                         const std::function<void(const std::string&, std::optional<double>)>& progress) {
    const auto tell = [&](const std::string& doing, std::optional<double> share) {
        if (progress) progress(doing, share);
    };
    tell("The cameras are being opened.", std::nullopt);
    auto left = opened(room.left, "Left camera", bell_, clock),
         right = opened(room.right, "Right camera", bell_, clock);
    left_ = left.get();
    right_ = right.get();
    PairSettings pairs;
    pairs.together = room.together;
    pairs.most_apart = from_seconds(room.max_apart_ms / 1e3);
    learn_clocks(clock, [&](double share) { tell("The clocks of the cameras are being learnt.", share); });
    pair_ = std::make_unique<PairedCameras>(std::move(left), std::move(right), bell_, clock, pairs);
}

/// A frame's time is as good as the quickest frame so far: the first ones may have come late.
void RoomCameras::learn_clocks(const Clock& clock, const std::function<void(double)>& progress) {
    constexpr std::size_t kFrames = 20;
    constexpr Instant kLeast = std::chrono::seconds(1), kMost = std::chrono::seconds(10);
    const Instant began = clock.now();
    const auto known = [](Camera& camera) { return camera.frames().counts().received >= kFrames; };
    const auto share = [&](Camera& camera) {
        return std::min(1.0, static_cast<double>(camera.frames().counts().received) / kFrames);
    };
    while (clock.now() - began < kLeast || !known(*left_) || !known(*right_)) {
        if (clock.now() - began > kMost) {  // a camera that stumbles at its start is opened again by itself until then
            Camera& slow = known(*left_) ? *right_ : *left_;
            if (const auto fault = slow.frames().fault()) throw DeviceError(slow.name(), fault->problem, fault->remedy);
            throw DeviceError(slow.name(), "it sent too few frames in ten seconds",
                              "Look at its trigger, its frame rate and the network.");
        }
        progress(std::min({share(*left_), share(*right_), seconds(clock.now() - began) / seconds(kLeast)}));
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    left_->frames().take_all();
    right_->frames().take_all();
}

std::vector<std::string> RoomCameras::notes() const {
    std::vector<std::string> notes;
    for (const Camera* camera : {left_, right_})
        for (const std::string& note : camera->notes()) notes.push_back(camera->name() + ": " + note);
    return notes;
}

CommandProjector::CommandProjector(const std::string& monitor, const std::filesystem::path& projector_file)
    : keeper_(monitor, settings_of(projector_file)), beats_([this](const std::stop_token& stop) {
          const SteadyClock clock;
          while (!stop.stop_requested()) {
              keeper_.window_lives();
              keeper_.session_lives(clock.now());
              std::this_thread::sleep_for(std::chrono::milliseconds(20));
          }
      }) {}

}  // namespace planlight
