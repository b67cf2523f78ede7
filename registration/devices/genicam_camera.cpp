#include "registration/devices/genicam_camera.h"

#include <arv.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <mutex>
#include <utility>

#include "planning_io/types/error.h"
#include "registration/devices/genicam_automatics.h"
#include "registration/devices/genicam_failure.h"
#include "registration/devices/genicam_offers.h"
#include "registration/devices/mono_pixels.h"

namespace planlight {
namespace {

constexpr int kBuffers = 6;  // on their way; more would only hide that nobody takes the frames
constexpr Instant kJustHeard = std::chrono::milliseconds(10);  // a frame's own taking over
constexpr Instant kPatience = std::chrono::milliseconds(100);
constexpr std::size_t kLearnt = 20;  // frames: one that came quickly is among them

struct Unref {
    void operator()(void* object) const {
        if (object) g_object_unref(object);
    }
};
using CameraPointer = std::unique_ptr<ArvCamera, Unref>;
using StreamPointer = std::unique_ptr<ArvStream, Unref>;

bool another_exposure(double now, double was) {
    return std::abs(now / was - 1) > 0.02;
}

bool another_gain(double gain, double than) {
    return std::abs(gain - than) > 0.02 * std::max(1.0, std::abs(than));
}

std::string text_or_empty(const char* text) {
    return text ? text : "";
}

}  // namespace

struct GenicamCamera::Device {
    CameraPointer camera;
    StreamPointer stream;
    std::atomic<bool> lost{false};
};

std::vector<FoundCamera> list_genicam_cameras() {
    // Aravis gives away its own texts, and frees them when another thread has the list made anew.
    static std::mutex mutex;
    const std::lock_guard lock(mutex);
    arv_update_device_list();
    std::vector<FoundCamera> found;
    for (unsigned i = 0; i < arv_get_n_devices(); ++i)
        found.push_back({text_or_empty(arv_get_device_id(i)), text_or_empty(arv_get_device_serial_nbr(i)),
                         text_or_empty(arv_get_device_vendor(i)), text_or_empty(arv_get_device_model(i)),
                         text_or_empty(arv_get_device_address(i)), text_or_empty(arv_get_device_protocol(i))});
    return found;
}

GenicamCamera::GenicamCamera(GenicamSettings settings, FrameBell& bell, const Clock& clock)
    : settings_(std::move(settings)), clock_(clock), frames_(bell), name_(settings_.name), device_(new Device) {
    open();
    serial_ = serial_of_device();
    name_ = fmt::format("{} (serial {})", settings_.name, serial_.empty() ? settings_.device : serial_);
    const Setup setup = configure();
    notes_ = setup.notes;
    width_ = setup.width;
    height_ = setup.height;
    global_shutter_ = setup.global_shutter;
    start();
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

GenicamCamera::~GenicamCamera() {
    thread_.request_stop();
    thread_.join();
    if (device_->camera) arv_camera_stop_acquisition(device_->camera.get(), GenicamFailure().slot());
}

void GenicamCamera::open() {
    std::string id = settings_.device;
    for (const FoundCamera& found : list_genicam_cameras())
        if (found.serial == settings_.device) id = found.id;
    GenicamFailure failure;
    device_->camera.reset(arv_camera_new(id.c_str(), failure.slot()));
    if (!device_->camera)
        throw DeviceError(name_, fmt::format("\"{}\" does not answer ({})", settings_.device, failure.text()),
                          "Look at its cable and power, end other programs that use it, and see `planlight devices`.");
}

std::string GenicamCamera::serial_of_device() const {
    return text_or_empty(arv_camera_get_device_serial_number(device_->camera.get(), GenicamFailure().slot()));
}

void GenicamCamera::refuse(const std::string& what, const std::string& why, const std::string& remedy) const {
    throw DeviceError(name_, fmt::format("does not take {} ({})", what, why), remedy);
}

constexpr const char* kSwitchOffAndOn = "Switch it off and on again, and end other programs that use it.";

void GenicamCamera::set_format_and_region() {
    ArvCamera* camera = device_->camera.get();
    GenicamFailure failure;
    arv_camera_stop_acquisition(camera, failure.slot());  // of a program that ended badly
    arv_camera_set_acquisition_mode(camera, ARV_ACQUISITION_MODE_CONTINUOUS, failure.slot());
    if (failure.happened()) refuse("continuous acquisition", failure.text(), kSwitchOffAndOn);
    const std::string format = settings_.pixel_format.empty() ? "Mono8" : settings_.pixel_format;
    arv_camera_set_pixel_format_from_string(camera, format.c_str(), failure.slot());
    if (failure.happened()) refuse("the pixel format " + format, failure.text(), offered_formats(camera));
    if (!settings_.region) return;
    const auto [x, y, width, height] = *settings_.region;
    arv_camera_set_region(camera, x, y, width, height, failure.slot());
    if (failure.happened())
        refuse(fmt::format("the region {} {} {} {}", x, y, width, height), failure.text(),
               "Give x, y, width and height within its sensor, each in the steps that its manual has.");
}

/// As told; what was not told as at the first opening: what another program set meanwhile, or a camera forgot, is set
/// back. Where that cannot be set, it must be what it was.
void GenicamCamera::set_exposure_and_gain() {
    ArvCamera* camera = device_->camera.get();
    GenicamFailure failure;
    const bool opened_before = exposure_ > Instant{};
    if (settings_.exposure_ms) {
        arv_camera_set_exposure_time(camera, 1e3 * *settings_.exposure_ms, failure.slot());
        if (failure.happened())
            refuse(fmt::format("an exposure of {} ms", *settings_.exposure_ms), failure.text(),
                   offered_range(camera, "exposure_ms", arv_camera_get_exposure_time_bounds, 1e-3));
    } else if (opened_before) {
        const double was_us = 1e6 * seconds(exposure_);
        arv_camera_set_exposure_time(camera, was_us, failure.slot());
        const double now_us = arv_camera_get_exposure_time(camera, failure.slot());
        if (failure.happened() || another_exposure(now_us, was_us))
            refuse(fmt::format("the exposure that it had, {:.2f} ms", was_us / 1e3),
                   fmt::format("it is {:.2f} ms", now_us / 1e3), kSwitchOffAndOn);
    }
    if (settings_.gain) {
        arv_camera_set_gain(camera, *settings_.gain, failure.slot());
        if (failure.happened())
            refuse(fmt::format("a gain of {}", *settings_.gain), failure.text(),
                   offered_range(camera, "gain", arv_camera_get_gain_bounds, 1));
    } else if (opened_before && arv_camera_is_gain_available(camera, failure.slot())) {
        arv_camera_set_gain(camera, gain_, failure.slot());
        const double gain = arv_camera_get_gain(camera, failure.slot());
        if (failure.happened() || another_gain(gain, gain_))
            refuse(fmt::format("the gain that it had, {:.1f}", gain_), fmt::format("it is {:.1f}", gain),
                   kSwitchOffAndOn);
    }
}

void GenicamCamera::set_trigger() {
    ArvCamera* camera = device_->camera.get();
    GenicamFailure failure;
    if (!settings_.line.empty()) {
        arv_camera_set_trigger(camera, settings_.line.c_str(), failure.slot());
        if (failure.happened()) refuse("the trigger " + settings_.line, failure.text(), offered_lines(camera));
        return;
    }
    arv_camera_clear_triggers(camera, failure.slot());
    if (!settings_.frames_hz) return;
    arv_camera_set_frame_rate(camera, *settings_.frames_hz, failure.slot());
    if (failure.happened())
        refuse(fmt::format("{} frames a second", *settings_.frames_hz), failure.text(),
               offered_range(camera, "frames_hz", arv_camera_get_frame_rate_bounds, 1));
}

GenicamCamera::Setup GenicamCamera::configure() {
    ArvCamera* camera = device_->camera.get();
    GenicamFailure failure;
    Setup setup;
    set_format_and_region();
    setup.notes = switch_off_automatics(camera);
    const Shutter shutter = shutter_of(camera);
    setup.global_shutter = shutter != Shutter::other && settings_.global_shutter.value_or(shutter == Shutter::global);
    // The rate of before may leave no room for this exposure: it is set before it as well, if it can be.
    if (settings_.frames_hz) arv_camera_set_frame_rate(camera, *settings_.frames_hz, GenicamFailure().slot());
    set_exposure_and_gain();
    set_trigger();
    const double exposure_us = arv_camera_get_exposure_time(camera, failure.slot());
    if (failure.happened() || !(exposure_us > 0))
        refuse("a question for its exposure", failure.text(), kSwitchOffAndOn);
    exposure_ = from_seconds(exposure_us / 1e6);
    if (settings_.exposure_ms && another_exposure(exposure_us, 1e3 * *settings_.exposure_ms))
        setup.notes.push_back(
            fmt::format("its exposure is {:.3f} ms, {:.3f} was asked for", exposure_us / 1e3, *settings_.exposure_ms));
    gain_ = arv_camera_is_gain_available(camera, failure.slot()) ? arv_camera_get_gain(camera, failure.slot()) : 0;
    int x = 0, y = 0;
    arv_camera_get_region(camera, &x, &y, &setup.width, &setup.height, failure.slot());
    if (failure.happened()) refuse("a question for its region", failure.text(), kSwitchOffAndOn);
    return setup;
}

void GenicamCamera::start() {
    ArvCamera* camera = device_->camera.get();
    GenicamFailure failure;
    // As large packets as the network lets through: fewer of them are lost.
    if (arv_camera_is_gv_device(camera)) arv_camera_gv_auto_packet_size(camera, failure.slot());
    const unsigned payload = arv_camera_get_payload(camera, failure.slot());
    if (link_.frame_bytes == 0 && arv_camera_is_gv_device(camera))  // before the thread runs
        link_ = {static_cast<int>(arv_camera_gv_get_packet_size(camera, failure.slot())), payload};
    transfer_ = from_seconds(settings_.transfer_ms ? *settings_.transfer_ms / 1e3 : payload / link_speed(camera));
    device_->stream.reset(arv_camera_create_stream(camera, nullptr, nullptr, failure.slot()));
    if (!device_->stream)
        throw DeviceError(name_, fmt::format("its stream cannot be opened ({})", failure.text()),
                          "Look at the firewall and the network's packet size.");
    if (ARV_IS_GV_STREAM(device_->stream.get()))
        g_object_set(device_->stream.get(), "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_AUTO, nullptr);
    for (int i = 0; i < kBuffers; ++i) arv_stream_push_buffer(device_->stream.get(), arv_buffer_new(payload, nullptr));
    device_->lost = false;
    g_signal_connect(arv_camera_get_device(camera), "control-lost",
                     G_CALLBACK(+[](ArvDevice*, gpointer lost) { *static_cast<std::atomic<bool>*>(lost) = true; }),
                     &device_->lost);
    arv_camera_start_acquisition(camera, failure.slot());
    if (failure.happened())
        throw DeviceError(name_, fmt::format("it does not start ({})", failure.text()), "Switch it off and on again.");
    device_clock_ = DeviceClock();
    last_by_device_ = Instant(-1);
    heard_at_ = looked_at_ = clock_.now();
    incomplete_before_ = frames_.counts().incomplete;
    repeated_before_ = frames_.counts().repeated;
    repeated_.forget();
}

/// One frame, or none within a moment. False when the camera is lost.
bool GenicamCamera::receive() {
    ArvBuffer* buffer =
        arv_stream_timeout_pop_buffer(device_->stream.get(), static_cast<guint64>(kPatience.count() / 1000));
    const Instant arrived = clock_.now();
    const bool there = !device_->lost && arrived - heard_at_ < settings_.silence_allowed;
    if (!buffer) return there;
    struct Back {
        ArvStream* stream;
        ArvBuffer* buffer;
        ~Back() { arv_stream_push_buffer(stream, buffer); }
    } back{device_->stream.get(), buffer};
    if (arv_buffer_get_status(buffer) != ARV_BUFFER_STATUS_SUCCESS) {
        frames_.count_incomplete();
        return there;
    }
    const Instant by_device(static_cast<Instant::rep>(arv_buffer_get_timestamp(buffer)));
    if (by_device == last_by_device_) return there;  // the same exposure twice
    last_by_device_ = by_device;
    std::size_t size = 0;
    const auto* data = static_cast<const std::uint8_t*>(arv_buffer_get_data(buffer, &size));
    gint line_padding = 0, end_padding = 0;
    arv_buffer_get_image_padding(buffer, &line_padding, &end_padding);
    auto picture = mono_picture({data, size}, arv_buffer_get_image_width(buffer), arv_buffer_get_image_height(buffer),
                                arv_buffer_get_image_pixel_format(buffer), line_padding);
    if (!picture) {
        frames_.fail({fmt::format("it sends pictures of format {:#x}, which are not grey ones",
                                  arv_buffer_get_image_pixel_format(buffer)),
                      "Set \"pixel_format\" to Mono8, Mono10, Mono12 or Mono16."});
        learning_ = true;  // until the next picture that is one
        heard_at_ = arrived;
        return true;
    }
    if (repeated_.is(*picture)) {
        frames_.count_repeated();
        return there;
    }
    heard_at_ = arrived;
    incomplete_before_ = frames_.counts().incomplete;
    repeated_before_ = frames_.counts().repeated;
    if (!clock_is_known(by_device, arrived)) return true;
    CameraFrame frame;
    frame.exposure = exposure_;
    frame.at = device_clock_.on_session_clock(by_device) - transfer_ - exposure_ / 2;
    frame.at_sigma = device_clock_.uncertainty();
    frame.picture = std::move(*picture);
    frames_.push(std::move(frame));
    return true;
}

/// False while its clock is not known well enough for a frame to have a time.
bool GenicamCamera::clock_is_known(Instant by_device, Instant arrived) {
    if (!device_clock_.add(by_device, arrived)) {
        frames_.count_jump();
        frames_.fail({fmt::format("its clock jumped by {:.0f} ms", 1e3 * seconds(device_clock_.last_jump())),
                      "It is learnt anew, which takes a second. If this comes back, exchange the camera."});
        learning_ = true;
    }
    frames_.note_clock(device_clock_.drift(), device_clock_.uncertainty(), device_clock_.behind());
    if (const double wrong = device_clock_.runs_wrong(); wrong != 0) {
        frames_.fail({fmt::format("its clock runs {:.1f} % {}", 100 * std::abs(wrong), wrong > 0 ? "fast" : "slow"),
                      "No camera's clock may: exchange the camera, or look at who sets its clock."});
        learning_ = ran_wrong_ = true;
    }
    if (!learning_) return true;
    if (device_clock_.size() < kLearnt || device_clock_.runs_wrong() != 0) return false;
    if (ran_wrong_ && device_clock_.span() < std::chrono::seconds(5)) return false;
    learning_ = ran_wrong_ = false;
    frames_.recovered();
    return true;
}

/// Whether exposure and gain are still what they were at the start; asked now and then, right after a frame: a camera
/// whose power has gone would be waited for, for seconds, before its silence is told.
bool GenicamCamera::still_as_set() {
    const Instant now = clock_.now();
    if (now - looked_at_ < settings_.look_every || now - heard_at_ > kJustHeard) return true;
    looked_at_ = now;
    GenicamFailure failure;
    const double exposure_us = arv_camera_get_exposure_time(device_->camera.get(), failure.slot());
    if (failure.happened()) return true;  // a lost camera tells by itself
    if (another_exposure(exposure_us, 1e6 * seconds(exposure_))) {
        frames_.fail({fmt::format("its exposure was changed from {:.2f} to {:.2f} ms by somebody else",
                                  1e3 * seconds(exposure_), exposure_us / 1e3),
                      "End the other program that uses this camera; it is set again by itself."});
        return false;
    }
    if (!arv_camera_is_gain_available(device_->camera.get(), failure.slot())) return true;
    const double gain = arv_camera_get_gain(device_->camera.get(), failure.slot());
    if (!failure.happened() && another_gain(gain, gain_)) {
        frames_.fail({fmt::format("its gain was changed from {:.1f} to {:.1f} by somebody else", gain_, gain),
                      "End the other program that uses this camera; it is set again by itself."});
        return false;
    }
    return true;
}

void GenicamCamera::reopen(const std::stop_token& stop) {
    device_->stream.reset();
    device_->camera.reset();
    for (;;) {
        for (int i = 0; i < 10; ++i) {
            if (stop.stop_requested()) return;
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
        }
        try {
            open();
            const Setup setup = configure();
            if (serial_of_device() != serial_ || setup.width != width_ || setup.height != height_)
                throw DeviceError(name_, "it came back as another camera, or with another resolution",
                                  "Connect that camera again, or start the session anew.");
            start();
            learning_ = true;
            return;
        } catch (const DeviceError& error) {
            device_->stream.reset();
            device_->camera.reset();
            frames_.fail({error.what(), error.remedy});
        }
    }
}

/// Nothing came, or nothing whole.
void GenicamCamera::tell_silence() {
    const auto allowed_ms = std::chrono::duration_cast<std::chrono::milliseconds>(settings_.silence_allowed).count();
    if (const std::size_t incomplete = frames_.counts().incomplete - incomplete_before_; incomplete > 0)
        frames_.fail(
            {fmt::format("no whole frame came from it for {} ms, and {} with packets lost", allowed_ms, incomplete),
             "Look at the network: its receive buffer (net.core.rmem_max), jumbo frames, other traffic."});
    else if (frames_.counts().repeated > repeated_before_ && !device_->lost)
        frames_.fail(sends_one_picture(allowed_ms));
    else if (device_->lost)
        frames_.fail({"the connection to it was lost",
                      "End other programs that use it, look at its cable. It is looked for every second."});
    else
        frames_.fail({fmt::format("nothing came from it for {} ms", allowed_ms),
                      "Look at its cable and its power. It is looked for every second."});
}

void GenicamCamera::run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        try {
            const bool there = receive();
            if (there && still_as_set()) continue;
            if (!there) tell_silence();
        } catch (const std::exception& fault) {  // no memory for a picture, say
            frames_.fail({fmt::format("its pictures cannot be taken ({})", fault.what()),
                          "Close other programs, or switch the camera off and on again."});
        }
        reopen(stop);
    }
}

}  // namespace planlight
