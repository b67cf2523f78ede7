#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "registration/devices/camera.h"
#include "registration/devices/device_clock.h"
#include "registration/devices/repeated_picture.h"

namespace planlight {

/// A GenICam camera that answers on the network or on USB.
struct FoundCamera {
    std::string id, serial, vendor, model, address, protocol;
};

/// All that answer now; takes about a second.
std::vector<FoundCamera> list_genicam_cameras();

/// How a GenICam camera is run. What is not said stays as the camera has it.
struct GenicamSettings {
    std::string name = "Camera";  ///< for messages: "Left camera"
    std::string device;           ///< serial, identifier or network address
    std::string line;             ///< of the hardware trigger, "Line0"; empty: it runs free
    std::string pixel_format;     ///< "Mono8", "Mono10", "Mono12", "Mono16" or packed; empty: Mono8
    std::optional<double> exposure_ms, gain, frames_hz;
    std::optional<std::array<int, 4>> region;  ///< x, y, width, height
    /// From the end of the exposure to the arrival of the quickest frame; empty: the payload over a gigabit.
    std::optional<double> transfer_ms;
    std::optional<bool> global_shutter;  ///< empty: as the camera says; true says it for one that cannot
    Instant silence_allowed = std::chrono::milliseconds(500);  ///< without a frame; then it is lost
    Instant look_every = std::chrono::milliseconds(150);       ///< whether exposure and gain are still what they were
};

/// A GigE Vision or USB3 Vision camera by Aravis, running by itself: what it does on its own (automatic exposure and
/// gain, gamma, sharpening) is switched off and read back; a frame with lost packets is no frame; a camera that is lost
/// is a fault that `FrameQueue` tells, and is looked for until it is back.
class GenicamCamera final : public Camera {
public:
    /// Throws DeviceError when there is no such camera, it is in use, or it does not take the settings.
    GenicamCamera(GenicamSettings settings, FrameBell& bell, const Clock& clock);
    ~GenicamCamera() override;
    GenicamCamera(const GenicamCamera&) = delete;
    GenicamCamera& operator=(const GenicamCamera&) = delete;

    const std::string& name() const override { return name_; }
    FrameQueue& frames() override { return frames_; }

    int width() const override { return width_; }
    int height() const override { return height_; }
    const std::string& serial() const override { return serial_; }
    std::vector<std::string> notes() const override { return notes_; }
    CameraLink link() const override { return link_; }
    bool global_shutter() const override { return global_shutter_; }

private:
    struct Device;
    struct Setup {
        std::vector<std::string> notes;
        int width = 0, height = 0;
        bool global_shutter = false;
    };
    void open();
    std::string serial_of_device() const;
    Setup configure();
    void set_format_and_region();
    void set_exposure_and_gain();
    void set_trigger();
    [[noreturn]] void refuse(const std::string& what, const std::string& why, const std::string& remedy) const;
    void start();
    void run(const std::stop_token& stop);
    bool receive();
    bool clock_is_known(Instant by_device, Instant arrived);
    bool still_as_set();
    void tell_silence();
    void reopen(const std::stop_token& stop);

    GenicamSettings settings_;
    const Clock& clock_;
    FrameQueue frames_;
    // Of the first opening, and never changed: another camera in its place is refused.
    std::string name_, serial_;
    std::vector<std::string> notes_;
    int width_ = 0, height_ = 0;
    bool global_shutter_ = false;
    CameraLink link_;
    std::unique_ptr<Device> device_;
    // Of the camera's thread, once it runs.
    DeviceClock device_clock_;
    Instant exposure_{}, transfer_{}, heard_at_{}, looked_at_{}, last_by_device_{-1};
    double gain_ = 0;
    bool learning_ = false;  ///< its clock, after a fault: its frames have no time yet
    bool ran_wrong_ = false;
    RepeatedPicture repeated_;
    std::size_t incomplete_before_ = 0, repeated_before_ = 0;  ///< when the last new frame came
    std::jthread thread_;
};

}  // namespace planlight
