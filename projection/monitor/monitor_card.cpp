#include "projection/monitor/monitor_card.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <thread>

#include "planning_io/types/error.h"
#include "projection/stroke_font.h"
#include "projection/text_line.h"

namespace planlight {
using Eigen::Vector2d;

RgbImage draw_monitor_card(const Monitor& monitor, int number) {
    RgbImage picture(monitor.width, monitor.height);
    const auto line = [&](const std::string& text, double at, double height, Rgb colour) {
        const double widest = 0.88 * monitor.width / std::max(0.1, text_width(code_points(text)));
        write_line(text, {monitor.width / 2.0, at * monitor.height}, std::min(height * monitor.height, widest), colour,
                   picture);
    };
    constexpr Rgb kWhite{255, 255, 255}, kGrey{150, 150, 150}, kAmber{255, 180, 60};
    line("PLANLIGHT PROJECTOR HERE?", 0.14, 0.06, kAmber);
    line(monitor.name, 0.4, 0.24, kWhite);
    line(fmt::format("number {}{}", number, monitor.primary ? ", primary" : ""), 0.62, 0.08, kWhite);
    std::string what = fmt::format("{} x {}", monitor.width, monitor.height);
    if (monitor.refresh_hz > 0) what += fmt::format(", {:g} Hz", monitor.refresh_hz);
    line(what, 0.75, 0.06, kGrey);
    if (const std::string who = monitor.model + (monitor.serial.empty() ? "" : " " + monitor.serial); !who.empty())
        line(who, 0.85, 0.05, kGrey);
    line("If this is on the patient's place: --projector " + monitor.name, 0.94, 0.035, kGrey);
    return picture;
}

std::vector<std::string> show_monitor_cards(const Clock& clock, double seconds, const std::function<bool()>& stop) {
    std::vector<std::string> left_out;
    std::vector<std::unique_ptr<ProjectorWindow>> windows;
    const std::vector<Monitor> monitors = list_monitors();
    const auto instead = [&](const Monitor& monitor, const Error& error) {
        left_out.push_back(monitor.name + ": " + error.what());
    };
    std::vector<Monitor> open;
    for (const Monitor& monitor : monitors) try {
            windows.push_back(std::make_unique<ProjectorWindow>(monitor.name, clock, true));
            open.push_back(monitor);
        } catch (const DeviceError& error) {
            instead(monitor, error);
        }
    const Instant until = clock.now() + from_seconds(seconds);
    for (std::size_t i = 0; i < windows.size(); ++i) {
        const auto number =
            std::find_if(monitors.begin(), monitors.end(), [&](const Monitor& m) { return m.name == open[i].name; });
        windows[i]->show(draw_monitor_card(open[i], static_cast<int>(number - monitors.begin())), until);
    }
    while (clock.now() < until && !stop() && !windows.empty()) {
        for (std::size_t i = windows.size(); i-- > 0;) try {
                windows[i]->refresh();
            } catch (const DeviceError& error) {
                instead(open[i], error);
                windows.erase(windows.begin() + static_cast<std::ptrdiff_t>(i));
                open.erase(open.begin() + static_cast<std::ptrdiff_t>(i));
            }
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    for (auto& window : windows) window->go_dark();
    return left_out;
}

}  // namespace planlight
