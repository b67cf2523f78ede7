#include "registration/devices/gstreamer_camera.h"

#include <fmt/format.h>
#include <gst/app/gstappsink.h>
#include <gst/gst.h>
#include <gst/video/video.h>

#include <cstring>
#include <mutex>
#include <utility>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

constexpr Instant kPatience = std::chrono::milliseconds(100), kStart = std::chrono::seconds(5);
// Two frames at most wait inside GStreamer, and the older goes: an old picture is never taken for a live one.
constexpr const char* kSink =
    " ! videoconvert ! video/x-raw,format=GRAY8 ! appsink name=planlight sync=false max-buffers=2 drop=true";

struct UnrefSample {
    void operator()(GstSample* sample) const { gst_sample_unref(sample); }
};
using SamplePointer = std::unique_ptr<GstSample, UnrefSample>;

}  // namespace

struct GstreamerCamera::Pipeline {
    GstElement* element = nullptr;
    GstElement* sink = nullptr;
    ~Pipeline() {
        if (!element) return;
        gst_element_set_state(element, GST_STATE_NULL);
        if (sink) gst_object_unref(sink);
        gst_object_unref(element);
    }
    /// What went wrong in it, where something did.
    std::string error() const {
        GstBus* bus = gst_element_get_bus(element);
        std::string text;
        if (GstMessage* message = gst_bus_pop_filtered(bus, GST_MESSAGE_ERROR)) {
            GError* error = nullptr;
            gst_message_parse_error(message, &error, nullptr);
            text = error ? error->message : "unknown";
            g_clear_error(&error);
            gst_message_unref(message);
        }
        gst_object_unref(bus);
        return text;
    }
};

GstreamerCamera::GstreamerCamera(GstreamerSettings settings, FrameBell& bell, const Clock& clock)
    : settings_(std::move(settings)), clock_(clock), frames_(bell) {
    static std::once_flag once;
    std::call_once(once, [] { gst_init(nullptr, nullptr); });
    open();
    const Instant until = clock_.now() + kStart;
    while (frames_.counts().received == 0) {
        if (!receive() || clock_.now() > until) {
            const std::string error = pipeline_->error();
            throw DeviceError(
                settings_.name,
                fmt::format("\"{}\" sends no frame{}", settings_.pipeline, error.empty() ? "" : " (" + error + ")"),
                "Try the pipeline with `gst-launch-1.0` and ` ! fakesink`.");
        }
    }
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

std::vector<std::string> GstreamerCamera::notes() const {
    return {"it cannot be asked for automatic exposure or a rolling shutter: set it up by its own means"};
}

GstreamerCamera::~GstreamerCamera() {
    thread_.request_stop();
    if (thread_.joinable()) thread_.join();
}

void GstreamerCamera::open() {
    auto pipeline = std::make_unique<Pipeline>();
    GError* error = nullptr;
    pipeline->element = gst_parse_launch((settings_.pipeline + kSink).c_str(), &error);
    if (error || !pipeline->element) {
        const std::string text = error ? error->message : "unknown";
        g_clear_error(&error);
        throw DeviceError(settings_.name, fmt::format("\"{}\" is no pipeline ({})", settings_.pipeline, text),
                          "Write it as for `gst-launch-1.0`, without a sink.");
    }
    pipeline->sink = gst_bin_get_by_name(GST_BIN(pipeline->element), "planlight");
    GstClock* monotonic = gst_system_clock_obtain();
    gst_pipeline_use_clock(GST_PIPELINE(pipeline->element), monotonic);
    offset_ = clock_.now() - Instant(static_cast<Instant::rep>(gst_clock_get_time(monotonic)));
    gst_object_unref(monotonic);
    gst_element_set_state(pipeline->element, GST_STATE_PLAYING);
    heard_at_ = clock_.now();
    begun_ = false;
    pipeline_ = std::move(pipeline);
}

/// One frame, or none within a moment. False when the camera is lost.
bool GstreamerCamera::receive() {
    const SamplePointer sample(
        gst_app_sink_try_pull_sample(GST_APP_SINK(pipeline_->sink), static_cast<GstClockTime>(kPatience.count())));
    const Instant now = clock_.now();
    if (!sample) {
        const bool ended = gst_app_sink_is_eos(GST_APP_SINK(pipeline_->sink));
        return !ended && now - heard_at_ < (begun_ ? settings_.silence_allowed : kStart);
    }
    begun_ = true;
    GstBuffer* buffer = gst_sample_get_buffer(sample.get());
    GstVideoInfo info;
    GstVideoFrame video;
    if (!gst_video_info_from_caps(&info, gst_sample_get_caps(sample.get())) ||
        !gst_video_frame_map(&video, &info, buffer, GST_MAP_READ)) {
        frames_.count_incomplete();
        heard_at_ = now;
        return true;
    }
    CameraFrame frame;
    frame.exposure = from_seconds(settings_.exposure_ms / 1e3);
    const bool timed = GST_BUFFER_PTS_IS_VALID(buffer);
    frame.at = timed ? Instant(static_cast<Instant::rep>(GST_BUFFER_PTS(buffer) +
                                                         gst_element_get_base_time(pipeline_->element))) +
                           offset_
                     : now;
    frame.at -= from_seconds(settings_.stamped_late_ms / 1e3);
    frame.at_sigma = timed ? std::chrono::milliseconds(1) : std::chrono::milliseconds(15);
    frame.picture = GrayImage(GST_VIDEO_FRAME_WIDTH(&video), GST_VIDEO_FRAME_HEIGHT(&video));
    const auto* rows = static_cast<const std::uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(&video, 0));
    const auto stride = static_cast<std::size_t>(GST_VIDEO_FRAME_PLANE_STRIDE(&video, 0)),
               columns = static_cast<std::size_t>(frame.picture.width);
    for (std::size_t y = 0; y < static_cast<std::size_t>(frame.picture.height); ++y)
        std::memcpy(frame.picture.pixels.data() + y * columns, rows + y * stride, columns);
    gst_video_frame_unmap(&video);
    if (width_ == 0) {  // before the thread runs
        width_ = frame.picture.width;
        height_ = frame.picture.height;
    }
    if (frame.picture.width != width_ || frame.picture.height != height_) {
        problem_ = {fmt::format("it sends {} x {} pixels now, and sent {} x {} at the beginning", frame.picture.width,
                                frame.picture.height, width_, height_),
                    "Set its resolution back, or start the session anew."};
        return false;
    }
    problem_ = {};
    if (repeated_.is(frame.picture)) {
        frames_.count_repeated();
        if (now - heard_at_ < settings_.silence_allowed) return true;
        problem_ = sends_one_picture(std::chrono::duration_cast<std::chrono::milliseconds>(now - heard_at_).count());
        return false;
    }
    heard_at_ = now;
    frames_.recovered();
    frames_.push(std::move(frame));
    return true;
}

void GstreamerCamera::run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        if (pipeline_ && receive()) continue;
        const std::string error = pipeline_ ? pipeline_->error() : "";
        if (!problem_.problem.empty())
            frames_.fail(problem_);
        else
            frames_.fail({error.empty() ? "nothing comes from its pipeline" : error,
                          "Look at its cable. It is opened again every second."});
        problem_ = {};
        pipeline_.reset();
        for (int i = 0; i < 10 && !stop.stop_requested(); ++i) std::this_thread::sleep_for(kPatience);
        try {
            if (!stop.stop_requested()) open();
        } catch (const DeviceError& problem) {
            frames_.fail({problem.what(), problem.remedy});
        }
    }
}

}  // namespace planlight
