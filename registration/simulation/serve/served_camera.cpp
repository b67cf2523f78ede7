#include "registration/simulation/serve/served_camera.h"

#include <arv.h>

#include <algorithm>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <optional>

#include "planning_io/types/error.h"

namespace planlight::simulation {

struct ServedCamera::Parts {
    struct Frame {
        GrayImage picture;
        Instant began;
    };
    ServedCameraSettings settings;
    std::mutex mutex;
    std::condition_variable offered;
    std::optional<Frame> newest;
    Frame sent;
    bool silent = false, ending = false;
    double lost_share = 0;
    Instant drifts_since{};             ///< by this machine's clock
    ArvGvFakeCamera* server = nullptr;  ///< null: it has no power

    ~Parts() { switch_off(); }
    void switch_on();
    void switch_off();
    ArvFakeCamera* camera() const { return arv_gv_fake_camera_get_fake_camera(server); }
    Instant by_its_clock(Instant t) const {
        const auto drift =
            static_cast<Instant::rep>(static_cast<double>((t - drifts_since).count()) * settings.clock_drift);
        return t + Instant(drift) + settings.clock_offset;
    }
    void fill(ArvBuffer* buffer);
};

/// Called by the server's own thread for each frame that is due; waits a little for a new one. Without one the last is
/// sent again with its own time, as a camera would not: who receives it tells by the time.
void ServedCamera::Parts::fill(ArvBuffer* buffer) {
    std::unique_lock lock(mutex);
    const auto wait_ms = std::chrono::milliseconds(60);
    offered.wait_for(lock, wait_ms, [&] { return ending || (newest && !silent); });
    if (newest && !silent) {
        sent = std::move(*newest);
        newest.reset();
    }
    const auto width = static_cast<std::size_t>(arv_buffer_get_image_width(buffer)),
               height = static_cast<std::size_t>(arv_buffer_get_image_height(buffer));
    std::size_t size = 0;
    // (The library counts what was received, which is nothing in a camera: the size is that of the picture.)
    auto* pixels = static_cast<std::uint8_t*>(const_cast<void*>(arv_buffer_get_data(buffer, &size)));
    if (!pixels) return;
    const std::size_t rows = std::min(height, static_cast<std::size_t>(sent.picture.height)),
                      columns = std::min(width, static_cast<std::size_t>(sent.picture.width));
    for (std::size_t y = 0; y < rows; ++y)
        std::memcpy(pixels + y * width, sent.picture.pixels.data() + y * static_cast<std::size_t>(sent.picture.width),
                    columns);
    arv_buffer_set_timestamp(buffer, static_cast<guint64>(std::max(Instant{}, by_its_clock(sent.began)).count()));
}

void ServedCamera::Parts::switch_on() {
    ending = false;
    const char* const features = settings.genicam_file.empty() ? nullptr : settings.genicam_file.c_str();
    server = arv_gv_fake_camera_new_full(settings.address.c_str(), settings.serial.c_str(), features);
    if (!server || !arv_gv_fake_camera_is_running(server))
        throw DeviceError("Served camera " + settings.serial, settings.address + " cannot be used",
                          "Give this machine the address (`ip address add " + settings.address +
                              "/8 dev lo`), one a camera, and end other cameras there.");
    g_object_set(server, "gvsp-lost-ratio", lost_share, nullptr);
    const auto set = [&](guint32 place, guint32 value) { arv_fake_camera_write_register(camera(), place, value); };
    set(ARV_FAKE_CAMERA_REGISTER_WIDTH, static_cast<guint32>(settings.width));
    set(ARV_FAKE_CAMERA_REGISTER_HEIGHT, static_cast<guint32>(settings.height));
    set(ARV_FAKE_CAMERA_REGISTER_ACQUISITION_FRAME_PERIOD_US, static_cast<guint32>(1e6 / settings.frames_hz));
    set(ARV_FAKE_CAMERA_REGISTER_EXPOSURE_TIME_US, static_cast<guint32>(settings.exposure.count() / 1000));
    arv_fake_camera_set_fill_pattern(
        camera(),
        [](ArvBuffer* buffer, void* parts, guint32, guint32, ArvPixelFormat) {
            static_cast<Parts*>(parts)->fill(buffer);
        },
        this);
}

void ServedCamera::Parts::switch_off() {
    {
        const std::lock_guard lock(mutex);
        ending = true;
    }
    offered.notify_all();
    if (server) g_object_unref(server);
    server = nullptr;
}

ServedCamera::ServedCamera(const ServedCameraSettings& settings) : parts_(new Parts) {
    parts_->settings = settings;
    parts_->sent = {GrayImage(settings.width, settings.height), Instant{}};
    parts_->switch_on();
}

ServedCamera::~ServedCamera() = default;

void ServedCamera::offer(GrayImage picture, Instant began) {
    {
        const std::lock_guard lock(parts_->mutex);
        parts_->newest = {std::move(picture), began};
    }
    parts_->offered.notify_all();
}

void ServedCamera::silence(bool silent) {
    const std::lock_guard lock(parts_->mutex);
    parts_->silent = silent;
}

void ServedCamera::set_clock_offset(Instant offset) {
    const std::lock_guard lock(parts_->mutex);
    parts_->settings.clock_offset = offset;
}

void ServedCamera::set_clock_drift(double seconds_a_second) {
    const std::lock_guard lock(parts_->mutex);
    // What it gained until now stays.
    const Instant now = parts_->sent.began;
    parts_->settings.clock_offset = parts_->by_its_clock(now) - now;
    parts_->drifts_since = now;
    parts_->settings.clock_drift = seconds_a_second;
}

Instant ServedCamera::clock_offset() const {
    const std::lock_guard lock(parts_->mutex);
    return parts_->settings.clock_offset;
}

void ServedCamera::power(bool on) {
    if (on == (parts_->server != nullptr)) return;
    if (on)
        parts_->switch_on();
    else
        parts_->switch_off();
}

void ServedCamera::lose_packets(double share) {
    parts_->lost_share = share;
    if (parts_->server) g_object_set(parts_->server, "gvsp-lost-ratio", share, nullptr);
}

void ServedCamera::change_exposure(Instant exposure) {
    if (parts_->server)
        arv_fake_camera_write_register(parts_->camera(), ARV_FAKE_CAMERA_REGISTER_EXPOSURE_TIME_US,
                                       static_cast<guint32>(exposure.count() / 1000));
}

void ServedCamera::write_register(std::uint32_t address, std::uint32_t value) {
    if (parts_->server) arv_fake_camera_write_register(parts_->camera(), address, value);
}

std::uint32_t ServedCamera::read_register(std::uint32_t address) const {
    guint32 value = 0;
    if (parts_->server) arv_fake_camera_read_register(parts_->camera(), address, &value);
    return value;
}

}  // namespace planlight::simulation
