#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "planning_io/types/image.h"
#include "planning_io/types/time.h"

namespace planlight::simulation {

/// What a served camera is to the network.
struct ServedCameraSettings {
    std::string address = "127.0.0.1";  ///< of this machine; each camera needs one of its own
    std::string serial = "SIM-1";
    int width = 0, height = 0;
    Instant exposure = std::chrono::milliseconds(10);
    double frames_hz = 25;
    Instant clock_offset{};      ///< of the camera's clock against this machine's monotonic one
    double clock_drift = 0;      ///< seconds a second by which it runs fast
    std::string genicam_file{};  ///< what it says of its features (GenICam XML); empty: a plain camera's
};

/// A GigE Vision camera that any program on the network can open: Aravis' fake camera with our pictures.
class ServedCamera {
public:
    /// Throws DeviceError when the address is not this machine's or is in use.
    explicit ServedCamera(const ServedCameraSettings& settings);
    ~ServedCamera();

    /// The newest exposure: its picture and when it began, by this machine's monotonic clock. Sent once, to whoever has
    /// the camera open; thrown away when nobody took it before the next.
    void offer(GrayImage picture, Instant began);

    /// As if it hung: it answers, and sends nothing new from now on.
    void silence(bool silent);
    /// Its power, or its cable: without, nothing answers at its address; with it again, it is as after being switched
    /// on, and sends only to who opens it anew. Throws DeviceError when the address was taken meanwhile.
    void power(bool on);
    /// This share of its packets never arrives, 0 to 1; it does not send them again when asked to.
    void lose_packets(double share);
    /// As another program would do it.
    void change_exposure(Instant exposure);
    /// The camera's clock is set anew, or runs otherwise from now on.
    void set_clock_offset(Instant offset);
    void set_clock_drift(double seconds_a_second);
    Instant clock_offset() const;
    /// Of its own memory, as its GenICam file lays it out.
    void write_register(std::uint32_t address, std::uint32_t value);
    std::uint32_t read_register(std::uint32_t address) const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace planlight::simulation
