#include "app/live/live_window.h"

#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <memory>

#include "app/case_model.h"
#include "app/live/live_session.h"
#include "app/live/steady_clock.h"
#include "app/windows/operator_window.h"
#include "planning_io/files/image_file.h"
#include "planning_io/types/error.h"
#include "projection/projector_window.h"

namespace planlight {
namespace {

/// Set by Ctrl-C or a polite kill: the loop ends as if the window had been closed, and everything is dark on the way
/// out.
volatile std::sig_atomic_t asked_to_end = 0;

/// The simulated room needs longer for a picture than a real one; the projector window forgives it this much.
constexpr auto kPictureValidity = std::chrono::milliseconds(2500);

/// The picture for a monitor of another size: scaled by nearest pixel, so that nothing is invented; black bars.
RgbImage fitted(const RgbImage& picture, int width, int height) {
    if (picture.width == width && picture.height == height) return picture;
    const double scale =
        std::min(static_cast<double>(width) / picture.width, static_cast<double>(height) / picture.height);
    const double left = (width - scale * picture.width) / 2, top = (height - scale * picture.height) / 2;
    RgbImage out(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const int sx = static_cast<int>((x + 0.5 - left) / scale), sy = static_cast<int>((y + 0.5 - top) / scale);
            if (x + 0.5 > left && y + 0.5 > top && sx < picture.width && sy < picture.height)
                out.at(x, y) = picture.at(sx, sy);
        }
    return out;
}

/// Keeps the projector window at the newest light of the session.
class LightWindow {
public:
    LightWindow(const std::string& monitor, const ProjectorWindowSettings& settings)
        : window_(monitor, clock_, false, settings) {}

    void follow(const LiveSession& session) {
        const auto light = session.light();
        if (light.number != number_) {
            number_ = light.number;
            if (light.picture)
                window_.show(fitted(*light.picture, window_.width(), window_.height()),
                             clock_.now() + kPictureValidity);
            else
                window_.go_dark();
        }
        window_.refresh();
    }
    void go_dark() noexcept { window_.go_dark(); }

private:
    SteadyClock clock_;
    ProjectorWindow window_;
    std::uint64_t number_ = 0;
};

/// The monitor for the light: as asked for, else the first that is not the primary one; empty when there is only one.
std::string light_monitor(const LiveOptions& options) {
    if (!options.projector_monitor.empty()) return options.projector_monitor;
    for (const auto& monitor : list_monitors())
        if (!monitor.primary) return monitor.name;
    return {};
}

/// Refuses a monitor that is not the projector which was measured.
void check_monitor(const std::string& name, const ProjectorFacts& facts) {
    const auto monitors = list_monitors();
    for (std::size_t i = 0; i < monitors.size(); ++i) {
        const Monitor& m = monitors[i];
        if (m.name != name && std::to_string(i) != name) continue;
        const auto other = [&](const std::string& what, const std::string& is, const std::string& was) {
            throw CheckFailedError(
                fmt::format("the projector on {} is not the one that was measured on {}: its {} is {}, was {}", m.name,
                            facts.made_on, what, is, was),
                "Connect that projector, set its resolution, or measure this one with `planlight projector`.");
        };
        if (facts.width > 0 && (m.width != facts.width || m.height != facts.height))
            other("resolution", fmt::format("{} x {}", m.width, m.height),
                  fmt::format("{} x {}", facts.width, facts.height));
        if (!facts.serial.empty() && !m.serial.empty() && m.serial != facts.serial)
            other("serial", m.serial, facts.serial);
        if (!facts.monitor.empty() && m.name != facts.monitor) other("monitor", m.name, facts.monitor);
    }
}

/// Presses the buttons in their order as soon as each is free: the session by itself.
class Autoplay {
public:
    OperatorAction next(const OperatorModel& model) {
        if (step_ == 0 && model.scan.enabled) return advance(OperatorAction::scan);
        if (step_ == 1 && model.do_register.enabled) return advance(OperatorAction::do_register);
        if (step_ == 2 && model.track.enabled) return advance(OperatorAction::track);
        return OperatorAction::none;
    }

private:
    OperatorAction advance(OperatorAction action) {
        ++step_;
        return action;
    }
    int step_ = 0;
};

/// A screenshot of the operator window whenever the status changes its kind, and the light of that moment beside it.
class Screenshots {
public:
    explicit Screenshots(std::filesystem::path folder) : folder_(std::move(folder)) {
        if (!folder_.empty()) std::filesystem::create_directories(folder_);
    }
    void take(OperatorWindow& window, const OperatorModel& model, const LiveSession& session) {
        if (folder_.empty()) return;
        const auto kind = static_cast<int>(model.status.kind);
        frames_ = kind == kind_ ? frames_ + 1 : 0;
        kind_ = kind;
        if (frames_ != kSettledFrames) return;
        write_png(window.screenshot(), folder_ / fmt::format("operator-{:02d}.png", ++number_));
        if (const auto light = session.light().picture)
            write_png(*light, folder_ / fmt::format("light-{:02d}.png", number_));
    }

private:
    static constexpr int kSettledFrames = 4;
    std::filesystem::path folder_;
    int kind_ = -1, frames_ = 0, number_ = 0;
};

}  // namespace

bool display_is_there() {
    return std::getenv("DISPLAY") != nullptr && *std::getenv("DISPLAY") != '\0';
}

int run_live(const Volume& volume, const Case& the_case, const CaseDrawing& drawing, const LiveOptions& options) {
    OperatorWindowSettings window_settings;
    if (!options.operator_monitor.empty()) window_settings.monitor = options.operator_monitor;
    OperatorWindow window(window_settings);
    std::unique_ptr<LightWindow> light;
    if (const std::string monitor = light_monitor(options); !monitor.empty()) {
        check_monitor(monitor, options.projector);
        ProjectorWindowSettings light_settings;
        light_settings.light_delay = options.projector.light_delay.value_or(light_settings.light_delay);
        light = std::make_unique<LightWindow>(monitor, light_settings);
    }
    LiveSession session(volume, the_case, drawing,
                        {options.preset, options.seed, options.speed_mm_s, options.keep_matches_in});
    Autoplay autoplay;
    Screenshots screenshots(options.screenshots);
    std::optional<std::chrono::steady_clock::time_point> projecting_since;
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, [](int) { asked_to_end = 1; });
    while (!asked_to_end) {
        const OperatorModel model = session.model();
        const OperatorAction action = window.frame(model);
        if (action == OperatorAction::quit) return 0;
        if (light && (action == OperatorAction::dark || action == OperatorAction::stop)) light->go_dark();
        // Landmarks that stand in the window count for every match of their scan: a match that they refuse stays
        // refused.
        if (action == OperatorAction::do_register || action == OperatorAction::use_landmarks)
            session.post_find_patient(window.landmarks());
        else
            session.post(action);
        if (options.autoplay) session.post(autoplay.next(model));
        if (light) light->follow(session);
        screenshots.take(window, model, session);
        if (const auto fault = session.fault(); !fault.empty()) throw std::runtime_error(fault);
        const auto now = std::chrono::steady_clock::now();
        if (session.projecting() && !projecting_since) projecting_since = now;
        if (options.end_after_s > 0 && projecting_since &&
            now - *projecting_since > std::chrono::duration<double>(options.end_after_s))
            return 0;
    }
    return 0;
}

void show_model(const OperatorModel& model, FitView view) {
    OperatorWindow window;
    window.set_fit_view(view);
    while (window.frame(model) != OperatorAction::quit) {
    }
}

std::vector<PointPair> click_landmarks(const OperatorModel& model, const std::vector<PointPair>& already) {
    OperatorWindow window;
    window.open_landmarks(already);
    for (;;) {
        const OperatorAction action = window.frame(model);
        if (action == OperatorAction::quit || action == OperatorAction::use_landmarks) return window.landmarks();
    }
}

}  // namespace planlight
