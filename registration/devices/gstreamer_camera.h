#pragma once

#include <memory>
#include <string>
#include <thread>

#include "registration/devices/camera.h"
#include "registration/devices/repeated_picture.h"

namespace planlight {

/// How a camera that GStreamer knows is run.
struct GstreamerSettings {
    std::string name = "Camera";  ///< for messages: "Left camera"
    /// The source and what it needs, as for `gst-launch-1.0`: "v4l2src device=/dev/video0". Converted to 8-bit grey
    /// behind.
    std::string pipeline;
    double exposure_ms = 10;  ///< as it is set by other means: nobody tells it here
    /// From mid-exposure to the time that the source stamps.
    double stamped_late_ms = 0;
    Instant silence_allowed = std::chrono::milliseconds(500);  ///< without a frame; then it is lost
};

/// Any camera that GStreamer has a source for (V4L2, UVC, vendors' plug-ins), by its own pipeline. The frames' own
/// times on the monotonic clock are used. Exposure and gain are the source's business: nothing here can switch off what
/// the camera does by itself, so GenICam cameras are to be preferred.
class GstreamerCamera final : public Camera {
public:
    /// Throws DeviceError when the pipeline cannot be made or sends no frame within five seconds.
    GstreamerCamera(GstreamerSettings settings, FrameBell& bell, const Clock& clock);
    ~GstreamerCamera() override;
    GstreamerCamera(const GstreamerCamera&) = delete;
    GstreamerCamera& operator=(const GstreamerCamera&) = delete;

    const std::string& name() const override { return settings_.name; }
    const std::string& serial() const override { return settings_.pipeline; }
    int width() const override { return width_; }
    int height() const override { return height_; }
    FrameQueue& frames() override { return frames_; }
    /// What nobody can ask it.
    std::vector<std::string> notes() const override;

private:
    struct Pipeline;
    void open();
    bool receive();
    void run(const std::stop_token& stop);

    GstreamerSettings settings_;
    const Clock& clock_;
    FrameQueue frames_;
    std::unique_ptr<Pipeline> pipeline_;
    Instant heard_at_{}, offset_{};  ///< session's clock less the pipeline's
    bool begun_ = false;             ///< a frame has come since it was opened last
    int width_ = 0, height_ = 0;     ///< of the first frame, and never changed
    CameraFault problem_;            ///< of the last frame, which was refused; empty: it was not
    RepeatedPicture repeated_;
    std::jthread thread_;
};

}  // namespace planlight
