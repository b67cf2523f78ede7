#include "app/doctor/examine_room.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "app/doctor/examine_machine.h"
#include "app/doctor/exposure.h"
#include "app/doctor/light_until_ended.h"
#include "app/live/room_cameras.h"
#include "planning_io/case/case_folder.h"
#include "planning_io/case/rig_file.h"
#include "planning_io/types/error.h"
#include "planning_io/types/statistics.h"
#include "projection/monitor/desktop_kind.h"
#include "projection/monitor/monitor_picture.h"
#include "registration/calibration/check_drift.h"
#include "registration/projector_measurement/measure_latency.h"
#include "registration/projector_measurement/record_light.h"

namespace planlight {
namespace {

double lit_share(const RgbImage& picture) {
    constexpr int kBlack = 12;
    const auto lit = std::ranges::count_if(picture.pixels,
                                           [](const Rgb& pixel) { return *std::ranges::max_element(pixel) > kBlack; });
    return static_cast<double>(lit) / static_cast<double>(std::max<std::size_t>(1, picture.pixels.size()));
}

CameraFigures figures_of(Camera& camera, const std::string& side, const RoomCamera& room, const CameraCounts& before,
                         double watched_s) {
    const CameraCounts now = camera.frames().counts();
    CameraFigures figures;
    figures.side = side;
    figures.serial = camera.serial();
    figures.width = camera.width();
    figures.height = camera.height();
    figures.asked_hz = room.frames_hz;
    figures.received = now.received - before.received;
    figures.incomplete = now.incomplete - before.incomplete;
    figures.repeated = now.repeated - before.repeated;
    figures.rate_hz = static_cast<double>(figures.received) / watched_s;
    figures.notes = camera.notes();
    return figures;
}

void note_clock(Camera& camera, const CameraCounts& before, CameraFigures& figures) {
    const CameraCounts now = camera.frames().counts();
    figures.own_clock = now.own_clock;
    figures.clock_drift = now.clock_drift;
    figures.clock_sigma_ms = 1e3 * seconds(now.clock_sigma);
    figures.clock_jumps = now.clock_jumps - before.clock_jumps;
}

bool same_size(const CameraFigures& camera, const CameraModel& calibrated) {
    return camera.width == calibrated.width && camera.height == calibrated.height;
}

/// Of one camera's tiles alone.
LatencyResult latency_of(LightRecording recording, bool right) {
    for (FrameBrightness& frame : recording.frames)
        for (auto* of : {&frame.tiles, &frame.saturated, &frame.at_zero})
            if (right)
                of->erase(of->begin(), of->begin() + std::min<std::ptrdiff_t>(kTiles, std::ssize(*of)));
            else
                of->resize(std::min<std::size_t>(kTiles, of->size()));
    return measure_latency(recording);
}

/// Days since a moment in ISO 8601; empty where that cannot be read.
std::optional<double> days_since(const std::string& iso) {
    std::tm then{};
    if (iso.size() < 10 || !strptime(iso.substr(0, 10).c_str(), "%Y-%m-%d", &then)) return std::nullopt;
    return std::difftime(std::time(nullptr), timegm(&then)) / 86400;
}

/// The lines so far, and what stops the rest.
class Examination {
public:
    Examination(const RoomFile& room, const ExamineSettings& settings) : room_(room), settings_(settings) {}

    std::vector<DoctorLine> whole() {
        try {
            look_at_all();
        } catch (const ExaminationEnded&) {  // what was found until then stays
        }
        return std::move(lines_);
    }

private:
    void look_at_all() {
        attempt("the case", "case, files", [&] { look_at_case(); });
        attempt("this computer", "computer", [&] {
            const std::filesystem::path folder = settings_.case_folder.empty() ? "." : settings_.case_folder;
            MachineFigures machine;
            ask_window_system([&] { machine = examine_machine(folder); });
            add(judge_machine(machine));
        });
        attempt("the rig file", "rig, file", [&] { rig_ = read_rig(room_.rig); });
        if (!room_.monitor.empty()) attempt("the monitor", "projector, monitor", [&] { look_at_monitor(); });
        attempt("the cameras", "cameras, opening", [&] { open_cameras(); });
        attempt("the projector", "projector, window", [&] { open_projector(); });
        if (monitor_) add(judge_monitor(*monitor_, rig_ ? rig_->projector : CameraModel{}));
        if (watched_ && watched_->pairs.problem.empty() && projector_) {
            if (!cameras_->recorded()) attempt("the projector's delay", "projector, delay", [&] { measure_delay(); });
            attempt("a scan", "rig, scan", [&] { scan(); });
        }
        if (watched_) judge_cameras();
    }

    void add(const DoctorLine& line) {
        lines_.push_back(line);
        if (settings_.found) settings_.found(line);
    }
    void add(const std::vector<DoctorLine>& more) {
        for (const DoctorLine& line : more) add(line);
    }

    template <class Step>
    void attempt(const std::string& what, const std::string& subject, Step step) {
        if (settings_.ended.stop_requested()) throw ExaminationEnded();
        if (settings_.under_way) settings_.under_way(what);
        try {
            step();
        } catch (const Error& error) {
            add(DoctorLine{subject, Health::stop, error.what(), error.remedy});
        } catch (const std::exception& error) {  // one that we did not foresee must not take the other lines with it
            add(line_of_failure(subject, error));
        }
        if (settings_.ended.stop_requested()) throw ExaminationEnded();
    }

    void ask_window_system(const std::function<void()>& question) const {
        if (settings_.ask_window_system)
            settings_.ask_window_system(question);
        else
            question();
    }

    void look_at_case() {
        if (settings_.case_folder.empty()) return;
        const Case the_case = read_case(settings_.case_folder);
        add(DoctorLine{"case, files", Health::good, title_of(the_case) + ": whole, every checksum fits", {}});
    }

    void look_at_monitor() {
        MonitorFigures figures;
        figures.wanted = room_.monitor;
        std::vector<Monitor> monitors;
        ask_window_system([&] { monitors = list_monitors(); });  // throws without a display: then nothing is judged
        for (const Monitor& monitor : monitors)
            if (monitor.name == room_.monitor) figures.found = monitor;
        if (figures.found) {
            try {
                figures.desktop_lit = lit_share(MonitorPicture(room_.monitor).look());
            } catch (const DeviceError&) {  // it cannot be read: what is asked of the monitor goes on
            }
            figures.composited = desktop_is_composited();
            figures.wayland = desktop_is_wayland();
        }
        monitor_ = figures;
        if (!room_.projector_file.empty()) monitor_->measured = read_projector_file(room_.projector_file);
    }

    void open_cameras() {
        cameras_ = std::make_unique<RoomCameras>(room_, clock_);
        left_before_ = cameras_->pair().left().frames().counts();
        right_before_ = cameras_->pair().right().frames().counts();
        watched_ = watch_cameras(cameras_->pair(), room_, clock_, settings_.watch);
        if (cameras_->recorded())
            add(DoctorLine{"cameras, recorded", Health::look, "a recording is played: nothing here is said of devices",
                           "Name the room's own cameras in room.json before a patient comes."});
    }

    /// Last, for their clocks are known the better the longer they run.
    void judge_cameras() {
        CameraFigures &left = watched_->left, &right = watched_->right;
        note_clock(cameras_->pair().left(), left_before_, left);
        note_clock(cameras_->pair().right(), right_before_, right);
        add(judge_camera(left, rig_ ? rig_->serials.left_camera : "", rig_ ? &rig_->left_camera : nullptr));
        add(judge_camera(right, rig_ ? rig_->serials.right_camera : "", rig_ ? &rig_->right_camera : nullptr));
        for (Camera* camera : {&cameras_->pair().left(), &cameras_->pair().right()}) {
            const CameraLink link = camera->link();
            add(judge_network({camera == &cameras_->pair().left() ? left.side : right.side, link.packet_bytes,
                               link.frame_bytes, receive_buffer_max()}));
        }
        add(judge_pairs(watched_->pairs));
    }

    void measure_delay() {
        DelayFigures delay = flash(*light_, cameras_->pair(), clock_);
        // (Of what was taken while flashing, frames may have been left out.)
        delay.frame_interval_ms = 1e3 / std::max(watched_->left.rate_hz, watched_->right.rate_hz);
        if (monitor_ && monitor_->measured.light_delay) delay.told_ms = 1e3 * seconds(*monitor_->measured.light_delay);
        add(judge_delay(delay));
    }

    void open_projector() {
        if (room_.monitor.empty() ? !cameras_ : !monitor_ || !monitor_->found) return;
        try {
            projector_ = std::make_unique<CommandProjector>(room_, cameras_.get());
            light_.emplace(projector_->projector(), settings_.ended);
            if (!monitor_) return;
            light_->show(RgbImage(light_->width(), light_->height()), clock_.now() + std::chrono::seconds(1));
            monitor_->covered = true;
        } catch (const Error& error) {
            light_.reset();
            projector_.reset();
            if (!monitor_) throw;
            monitor_->problem = error.what();
            monitor_->remedy = error.remedy;
        }
    }

    void scan() {
        StripeSettings stripes;
        stripes.width = light_->width();
        stripes.height = light_->height();
        const ScanCapture capture = capture_scan(*light_, cameras_->pair(), clock_, stripes);
        for (const bool right : {false, true}) {
            const auto& pictures = right ? capture.right : capture.left;
            const Exposure exposure = exposure_of(pictures[0], pictures[1]);
            add(judge_picture({right ? "right camera" : "left camera", exposure.lit_share, exposure.saturated_share,
                               exposure.brightest_lit_grey, fringe_share(pictures, stripes), stripes.phase_period_px}));
        }
        // Another size is a line of its own already.
        if (!rig_ || !same_size(watched_->left, rig_->left_camera) || !same_size(watched_->right, rig_->right_camera) ||
            stripes.width != rig_->projector.width || stripes.height != rig_->projector.height)
            return;
        add(judge_rig(check_drift(scan_from_capture(capture, *rig_), *rig_), days_since(rig_->made_on)));
    }

    const RoomFile& room_;
    const ExamineSettings& settings_;
    SteadyClock clock_;
    std::vector<DoctorLine> lines_;
    std::optional<RigCalibration> rig_;
    std::optional<MonitorFigures> monitor_;
    std::unique_ptr<RoomCameras> cameras_;
    CameraCounts left_before_, right_before_;  ///< when they were opened and their clocks known
    std::optional<WatchedCameras> watched_;
    std::unique_ptr<CommandProjector> projector_;
    std::optional<LightUntilEnded> light_;  ///< of `projector_`
};

}  // namespace

std::vector<DoctorLine> examine_room(const RoomFile& room, const ExamineSettings& settings) {
    return Examination(room, settings).whole();
}

DoctorLine line_of_failure(const std::string& subject, const std::exception& error) {
    return {subject, Health::stop, std::string("it could not be examined: ") + error.what(),
            "Mend what the other lines name, then run this again; if it stays, report it."};
}

WatchedCameras watch_cameras(PairedCameras& cameras, const RoomFile& room, const Clock& clock, Instant how_long) {
    WatchedCameras watched;
    const CameraCounts left = cameras.left().frames().counts(), right = cameras.right().frames().counts();
    const Instant began = clock.now();
    std::vector<double> apart_ms;
    Instant seen_until = began;
    try {
        while (clock.now() - began < how_long) {
            const StereoFrame frame = cameras.grab(seen_until, std::chrono::milliseconds(1000));
            seen_until = frame.at + frame.exposure / 2;
            ++watched.pairs.pairs;
            apart_ms.push_back(1e3 * seconds(cameras.counts().apart));
        }
    } catch (const DeviceError& error) {
        watched.pairs.problem = error.what();
        watched.pairs.remedy = error.remedy;
    }
    const double watched_s = seconds(clock.now() - began);
    watched.left = figures_of(cameras.left(), "left camera", room.left, left, watched_s);
    watched.right = figures_of(cameras.right(), "right camera", room.right, right, watched_s);
    watched.pairs.left = watched.left.received;
    watched.pairs.right = watched.right.received;
    if (!apart_ms.empty()) watched.pairs.apart_ms = median(apart_ms);
    watched.pairs.allowed_ms = 1e3 * seconds(cameras.counts().allowed);
    return watched;
}

DelayFigures flash(Projector& projector, StereoCamera& cameras, const Clock& clock) {
    RecordSettings settings;
    settings.code_passes = 1;
    settings.code_bits = 36;
    const LightBench bench{
        projector, cameras, clock, [&](Instant at) { std::this_thread::sleep_for(at - clock.now()); }, {}, {}};
    const LightRecording recording = record_latency(bench, settings);
    const LatencyResult both = measure_latency(recording);
    DelayFigures delay;
    if (both.refusal) {
        delay.problem = both.refusal->reason;
        delay.remedy = both.refusal->remedy;
        return delay;
    }
    delay.measured_ms = 1e3 * both.light_delay_s;
    delay.sigma_ms = 1e3 * std::max(both.median_sigma_s, both.jitter_s);
    delay.frame_interval_ms = 1e3 * both.frames.interval_s;
    const LatencyResult left = latency_of(recording, false), right = latency_of(recording, true);
    if (!left.refusal && !right.refusal) delay.right_later_ms = 1e3 * (right.median_s - left.median_s);
    return delay;
}

}  // namespace planlight
