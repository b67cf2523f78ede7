#pragma once

#include "app/recording/recording_cursor.h"
#include "registration/devices/projector.h"
#include "registration/devices/stereo_camera.h"

namespace planlight {

/// Thrown where a replay comes to something else than was recorded.
struct ReplayDiffers {
    std::string what;
};

/// In words, for `ReplayDiffers`.
std::string words_of(const RecordingCursor::Next& next);

/// Projector, cameras and clock that answer as a recording says. Whatever is asked of them in another order, or another
/// picture than was shown, throws ReplayDiffers; the end of the recording ReplayEnds; a device that failed DeviceError.
class RecordedDevices final : public Projector, public StereoCamera, public Clock {
public:
    /// Keeps a reference to the cursor. `width` and `height`: of the projector.
    RecordedDevices(RecordingCursor& cursor, int width, int height) : cursor_(cursor), width_(width), height_(height) {}

    int width() const override { return width_; }
    int height() const override { return height_; }
    Instant show(const RgbImage& picture, Instant valid_until) override;
    /// In a destructor, too, where nothing may be thrown: what differs is found at the next answer.
    void go_dark() noexcept override;
    StereoFrame grab(Instant not_before, std::chrono::milliseconds patience) override;
    bool wait_until_exposed(Instant not_before, std::chrono::milliseconds patience) override;
    std::string doubt() const override;
    Instant now() const override;
    /// To be called between two pictures of a scan, where a person may have ended it: throws what was said then.
    void stop_if_stopped();

    /// What was given so far.
    struct Given {
        int pictures = 0, frames = 0;
        std::uint64_t last_number = 0;  ///< of the last frame
        Instant first_at{}, last_at{};  ///< of the frames
    };
    const Given& given() const { return given_; }

private:
    RecordedInput answer(RecordedInput::Kind kind) const;

    RecordingCursor& cursor_;
    int width_, height_;
    mutable std::string doubt_;
    Given given_;
};

}  // namespace planlight
