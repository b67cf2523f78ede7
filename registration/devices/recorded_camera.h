#pragma once

#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "registration/devices/camera.h"
#include "registration/devices/recorded_play.h"

namespace planlight {

/// Of a recorded camera.
struct RecordedSettings {
    std::string name = "Camera";  ///< for messages: "Left camera"
    std::string serial;           ///< of the camera that it was recorded with; empty: not known
    std::string from;             ///< where its pictures come from, for a person
};

/// A camera that plays pictures which were recorded: for looking at them, and for trying a room without hardware.
class RecordedCamera final : public Camera {
public:
    /// `pictures`: of this camera, all of one size, in the order that `play` counts them.
    RecordedCamera(RecordedSettings settings, std::vector<GrayImage> pictures, std::shared_ptr<RecordedPlay> play,
                   FrameBell& bell, const Clock& clock);
    ~RecordedCamera() override;
    RecordedCamera(const RecordedCamera&) = delete;
    RecordedCamera& operator=(const RecordedCamera&) = delete;

    const std::string& name() const override { return settings_.name; }
    const std::string& serial() const override { return settings_.serial; }
    int width() const override { return pictures_.front().width; }
    int height() const override { return pictures_.front().height; }
    std::vector<std::string> notes() const override;
    FrameQueue& frames() override { return frames_; }

private:
    void run(const std::stop_token& stop);

    RecordedSettings settings_;
    std::vector<GrayImage> pictures_;
    std::shared_ptr<RecordedPlay> play_;
    const Clock& clock_;
    FrameQueue frames_;
    std::jthread thread_;
};

/// Brings into `queue` what is due by `now` after exposure `after`; the number of the last one that was.
std::uint64_t play_into(FrameQueue& queue, RecordedPlay& play, const std::vector<GrayImage>& pictures,
                        std::uint64_t after, Instant now);

}  // namespace planlight
