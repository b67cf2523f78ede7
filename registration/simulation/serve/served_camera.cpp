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
    ArvGvFakeCamera* server = nullptr;

    ~Parts() {
        {
            const std::lock_guard lock(mutex);
            ending = true;
        }
        offered.notify_all();
        if (server) g_object_unref(server);
    }
    ArvFakeCamera* camera() const { return arv_gv_fake_camera_get_fake_camera(server); }
    Instant by_its_clock(Instant t) const {
        const auto drift = static_cast<Instant::rep>(static_cast<double>(t.count()) * settings.clock_drift);
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

ServedCamera::ServedCamera(const ServedCameraSettings& settings) : parts_(new Parts) {
    parts_->settings = settings;
    parts_->sent = {GrayImage(settings.width, settings.height), Instant{}};
    parts_->server = arv_gv_fake_camera_new(settings.address.c_str(), settings.serial.c_str());
    if (!parts_->server || !arv_gv_fake_camera_is_running(parts_->server))
        throw DeviceError("Served camera " + settings.serial, settings.address + " cannot be used",
                          "Give this machine the address (`ip address add " + settings.address +
                              "/8 dev lo`), one a camera, and end other cameras there.");
    ArvFakeCamera* camera = parts_->camera();
    arv_fake_camera_write_register(camera, ARV_FAKE_CAMERA_REGISTER_WIDTH, static_cast<guint32>(settings.width));
    arv_fake_camera_write_register(camera, ARV_FAKE_CAMERA_REGISTER_HEIGHT, static_cast<guint32>(settings.height));
    arv_fake_camera_write_register(camera, ARV_FAKE_CAMERA_REGISTER_ACQUISITION_FRAME_PERIOD_US,
                                   static_cast<guint32>(1e6 / settings.frames_hz));
    change_exposure(settings.exposure);
    arv_fake_camera_set_fill_pattern(
        camera,
        [](ArvBuffer* buffer, void* parts, guint32, guint32, ArvPixelFormat) {
            static_cast<Parts*>(parts)->fill(buffer);
        },
        parts_.get());
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

void ServedCamera::change_exposure(Instant exposure) {
    arv_fake_camera_write_register(parts_->camera(), ARV_FAKE_CAMERA_REGISTER_EXPOSURE_TIME_US,
                                   static_cast<guint32>(exposure.count() / 1000));
}

}  // namespace planlight::simulation
