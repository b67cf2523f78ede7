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
    settings.global_shutter = camera.global_shutter;
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
    const Progress tell = [&](const std::string& doing, std::optional<double> share) {
        if (progress) progress(doing, share);
    };
    if (room.recorded) {
        tell("The recording is being read.", std::nullopt);
        open_recorded(*room.recorded, clock);
    } else {
        open_real(room, clock, tell);
    }
}

void RoomCameras::open_real(const RoomFile& room, const Clock& clock, const Progress& tell) {
    tell("The cameras are being opened.", std::nullopt);
    auto left = opened(room.left, "Left camera", bell_, clock),
         right = opened(room.right, "Right camera", bell_, clock);
    left_ = left.get();
    right_ = right.get();
    learn_clocks(clock, [&](double share) { tell("The clocks of the cameras are being learnt.", share); });
    pair_ = std::make_unique<PairedCameras>(std::move(left), std::move(right), bell_, clock, pair_settings(room));
}

void RoomCameras::open_recorded(const RoomRecording& recording, const Clock& clock) {
    RecordedRoom room = read_recorded_room(recording);
    recorded_ = true;
    if (room.has_scan()) {
        light_ = std::make_shared<RecordedLight>();
        light_width_ = room.projector_width;
        light_height_ = room.projector_height;
        which_ = std::move(room.which);
    }
    auto play = std::make_shared<RecordedPlay>(
        std::move(room.frames), recording.fastest ? RecordedPace::fastest : RecordedPace::own, clock.now(), light_);
    const std::string from = (recording.frames.empty() ? recording.capture : recording.frames).string();
    const auto camera = [&](const char* name, const std::string& serial, std::vector<GrayImage> pictures) {
        return std::make_unique<RecordedCamera>(RecordedSettings{name, serial, from}, std::move(pictures), play, bell_,
                                                clock);
    };
    auto left = camera("Left camera", room.serials.left_camera, std::move(room.left)),
         right = camera("Right camera", room.serials.right_camera, std::move(room.right));
    left_ = left.get();
    right_ = right.get();
    pair_ = std::make_unique<PairedCameras>(std::move(left), std::move(right), bell_, clock);
}

std::unique_ptr<Projector> RoomCameras::recorded_projector(const Clock& clock, Projector* behind) const {
    if (!light_) return nullptr;
    return std::make_unique<RecordedProjector>(light_width_, light_height_, which_, light_, clock, behind);
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

PairSettings pair_settings(const RoomFile& room) {
    PairSettings pairs;
    pairs.together = room.together;
    pairs.most_apart = from_seconds(room.max_apart_ms / 1e3);
    return pairs;
}

DeviceError no_projector() {
    return DeviceError("Projector", "the recorded room has neither a monitor nor a scan that was recorded",
                       "Name \"capture\" beside \"frames\" in room.json, or the projector's monitor.");
}

CommandProjector::CommandProjector(const RoomFile& room, const RoomCameras* cameras) {
    if (!room.monitor.empty())
        keeper_ = std::make_unique<ProjectorKeeper>(room.monitor, settings_of(room.projector_file));
    if (cameras) recorded_ = cameras->recorded_projector(clock_, keeper_.get());
    if (!keeper_ && !recorded_) throw no_projector();
    if (!keeper_) return;
    beats_ = std::jthread([this](const std::stop_token& stop) {
        while (!stop.stop_requested()) {
            keeper_->window_lives();
            keeper_->session_lives(clock_.now());
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
    });
}

}  // namespace planlight
