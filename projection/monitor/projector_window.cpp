#define GLFW_INCLUDE_NONE
#include "projection/monitor/projector_window.h"

#include <GLFW/glfw3.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <thread>
#include <utility>

#include "planning_io/types/error.h"
#include "projection/monitor/desktop_kind.h"
#include "projection/monitor/edid.h"
#include "projection/monitor/glfw_session.h"
#include "projection/monitor/monitor_lock.h"
#include "projection/monitor/monitors_kept_on.h"
#include "projection/monitor/output_turn.h"
#include "projection/monitor/picture_thread.h"
#include "projection/monitor/projector_hints.h"
#include "projection/monitor/window_above.h"

namespace planlight {
namespace {

constexpr auto kLandingPatience = std::chrono::milliseconds(1500);
const char* const kUseX11 = "Log in to one of X11 (\"on Xorg\"), best without a compositor (openbox).";
constexpr auto kTurnLooks = std::chrono::milliseconds(100);     ///< how often the output is asked how it is turned
constexpr auto kAboveAllowed = std::chrono::milliseconds(120);  ///< for another window to be before ours
constexpr auto kSettled =
    std::chrono::milliseconds(150);  ///< a window manager may still move a window that just landed

std::vector<GLFWmonitor*> monitors_now() {
    int count = 0;
    GLFWmonitor** const monitors = glfwGetMonitors(&count);
    return {monitors, monitors + count};
}

Monitor describe(GLFWmonitor* monitor) {
    Monitor result;
    result.name = glfwGetMonitorName(monitor);
    glfwGetMonitorPos(monitor, &result.x, &result.y);
    if (const GLFWvidmode* mode = glfwGetVideoMode(monitor)) {
        result.width = mode->width;
        result.height = mode->height;
        result.refresh_hz = mode->refreshRate;
    }
    result.primary = monitor == glfwGetPrimaryMonitor();
    return result;
}

std::string names_of(const std::vector<Monitor>& monitors) {
    std::string names;
    for (const Monitor& m : monitors)
        names += (names.empty() ? "" : ", ") + m.name + " (" + std::to_string(m.width) + "x" +
                 std::to_string(m.height) + (m.primary ? ", primary)" : ")");
    return names.empty() ? "none" : names;
}

std::string rectangle_size(int width, int height) {
    return std::to_string(width) + "x" + std::to_string(height);
}

std::string rectangle(int x, int y, int width, int height) {
    return rectangle_size(width, height) + " at " + std::to_string(x) + "," + std::to_string(y);
}

/// The index of the monitor of that name, or of that index as text.
std::size_t choose(const std::vector<Monitor>& monitors, const std::string& wanted, bool allow_only_monitor) {
    auto found = std::find_if(monitors.begin(), monitors.end(), [&](const Monitor& m) { return m.name == wanted; });
    for (std::size_t i = 0; found == monitors.end() && i < monitors.size(); ++i)
        if (std::to_string(i) == wanted) found = monitors.begin() + static_cast<std::ptrdiff_t>(i);
    if (found == monitors.end())
        throw DeviceError("Projector window", "there is no monitor \"" + wanted + "\"; there is: " + names_of(monitors),
                          "Connect the projector, or name one of these.");
    if (!allow_only_monitor && (found->primary || monitors.size() == 1))
        throw DeviceError("Projector window",
                          "monitor " + found->name +
                              (monitors.size() == 1 ? " is the only one" : " is the primary one") +
                              ": the light would cover the operator's screen; there is: " + names_of(monitors),
                          "Choose the projector's monitor, or make the operator's screen the primary one.");
    return static_cast<std::size_t>(found - monitors.begin());
}

/// Undecorated, above all, not yet seen. Full-screen mode is not used: under some window managers it lands on another
/// monitor than the one asked for.
GLFWwindow* hidden_window(const Monitor& monitor) {
    glfwDefaultWindowHints();
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_AUTO_ICONIFY, GLFW_FALSE);
    glfwWindowHint(GLFW_DECORATED, GLFW_FALSE);
    glfwWindowHint(GLFW_RESIZABLE, GLFW_FALSE);
    glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
    glfwWindowHint(GLFW_FLOATING, GLFW_TRUE);
    glfwWindowHint(GLFW_FOCUS_ON_SHOW, GLFW_FALSE);
    glfwWindowHint(GLFW_FOCUSED, GLFW_FALSE);
    glfwWindowHint(GLFW_ALPHA_BITS, 0);
    GLFWwindow* const window = glfwCreateWindow(monitor.width, monitor.height, "Planlight projector", nullptr, nullptr);
    if (window == nullptr)
        throw DeviceError("Projector window", "it could not be opened (" + last_window_error() + ")",
                          "Install an OpenGL 3.3 driver, or set LIBGL_ALWAYS_SOFTWARE=1.");
    glfwSetInputMode(window, GLFW_CURSOR, GLFW_CURSOR_HIDDEN);
    set_projector_hints(window);
    return window;
}

}  // namespace

std::vector<Monitor> list_monitors() {
    const auto session = glfw_session();
    std::vector<Monitor> result;
    for (GLFWmonitor* monitor : monitors_now()) {
        result.push_back(describe(monitor));
        if (const auto edid = edid_of_output(result.back().name)) {
            result.back().model = edid->name.empty() ? edid->manufacturer : edid->name;
            result.back().serial = edid->serial;
        }
    }
    return result;
}

struct ProjectorWindow::Parts {
    std::shared_ptr<void> session = glfw_session();
    const MonitorsKeptOn kept_on;
    ProjectorWindowSettings settings;
    const Clock& clock;
    GLFWmonitor* handle = nullptr;
    Monitor monitor;
    std::optional<MonitorLock> lock;
    GLFWwindow* window = nullptr;
    std::optional<PictureThread> picture;
    bool damaged = false;
    bool only_monitor_allowed;
    std::optional<OutputTurn> turn;  ///< at the beginning
    std::optional<WindowAbove> above;
    std::chrono::steady_clock::time_point turn_looked_at{};
    std::optional<std::chrono::steady_clock::time_point> above_since;

    Parts(const std::string& wanted, const Clock& c, bool allow_only_monitor, const ProjectorWindowSettings& s)
        : settings(s), clock(c), only_monitor_allowed(allow_only_monitor) {
        glfwPollEvents();
        if (desktop_is_wayland())
            throw DeviceError("Projector window",
                              "this is a Wayland desktop: what covers the light, or keeps it, cannot be seen", kUseX11);
        const std::vector<GLFWmonitor*> handles = monitors_now();
        const std::size_t index = choose(list_monitors(), wanted, allow_only_monitor);
        handle = handles.at(index);
        monitor = describe(handle);
        turn = output_turn(handle);
        refuse_scaled();
        lock.emplace(monitor.name);
        window = hidden_window(monitor);
        above.emplace(window);
        glfwSetWindowUserPointer(window, this);
        glfwSetWindowRefreshCallback(
            window, [](GLFWwindow* w) { static_cast<Parts*>(glfwGetWindowUserPointer(w))->damaged = true; });
        try {
            picture.emplace(window, monitor.width, monitor.height, clock);
            land();
        } catch (...) {
            close();
            throw;
        }
    }
    Parts(const Parts&) = delete;
    Parts& operator=(const Parts&) = delete;
    ~Parts() { close(); }

    void refuse_scaled() const {
        if (!turn || (!turn->scaled && turn->width == monitor.width && turn->height == monitor.height)) return;
        throw DeviceError("Projector window",
                          "monitor " + monitor.name + " is scaled: it shows " +
                              rectangle_size(turn->width, turn->height) + " of the desktop on " +
                              rectangle_size(monitor.width, monitor.height) + " pixels",
                          "Set its scale to 1, in the desktop's settings of monitors or with xrandr.");
    }

    void close() noexcept {
        picture.reset();
        above.reset();
        if (window != nullptr) glfwDestroyWindow(window);
        window = nullptr;
    }

    /// Onto the monitor, then seen, then checked until it has stayed there for a while.
    void land() {
        glfwSetWindowPos(window, monitor.x, monitor.y);
        glfwShowWindow(window);
        picture->redraw();  // what was drawn before it was seen is not there
        const auto start = std::chrono::steady_clock::now();
        auto wrong_at = start;
        while (true) {
            glfwPollEvents();
            const auto now = std::chrono::steady_clock::now();
            const std::string problem = misplacement();
            if (!problem.empty()) {
                wrong_at = now;
                glfwSetWindowPos(window, monitor.x, monitor.y);
            }
            if (problem.empty() && now - wrong_at > kSettled) break;
            if (now - start > kLandingPatience)
                refuse(problem.empty() ? "the window does not stay on its monitor" : problem);
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        picture->read_back(true);
        picture->redraw();
    }

    /// Why the window does not cover exactly its monitor; empty when it does.
    std::string misplacement() const {
        const std::vector<GLFWmonitor*> handles = monitors_now();
        if (std::find(handles.begin(), handles.end(), handle) == handles.end())
            return "monitor " + monitor.name + " is no longer connected";
        const Monitor now = describe(handle);
        if (!only_monitor_allowed && (now.primary || handles.size() == 1))
            return "monitor " + monitor.name + " is now the " + (handles.size() == 1 ? "only" : "primary") +
                   " one: nobody would see the operator's window";
        if (now.x != monitor.x || now.y != monitor.y || now.width != monitor.width || now.height != monitor.height)
            return "monitor " + monitor.name + " is now " + rectangle(now.x, now.y, now.width, now.height) + ", was " +
                   rectangle(monitor.x, monitor.y, monitor.width, monitor.height);
        if (glfwGetWindowAttrib(window, GLFW_ICONIFIED) == GLFW_TRUE ||
            glfwGetWindowAttrib(window, GLFW_VISIBLE) == GLFW_FALSE)
            return "the window is not seen";
        int x = 0, y = 0, width = 0, height = 0;
        glfwGetWindowPos(window, &x, &y);
        glfwGetFramebufferSize(window, &width, &height);
        if (x == monitor.x && y == monitor.y && width == monitor.width && height == monitor.height) return {};
        return "the window is " + rectangle(x, y, width, height) + " and should be " +
               rectangle(monitor.x, monitor.y, monitor.width, monitor.height);
    }

    /// Dark, and off whatever screen it covers.
    [[noreturn]] void refuse(const std::string& problem) {
        picture->go_dark();
        glfwHideWindow(window);
        glfwPollEvents();
        throw DeviceError("Projector window", problem,
                          "Connect the projector, check the monitor arrangement, and open the projector again.");
    }

    /// A window whose picture nobody draws any more is taken off the screen, for it could go on to show the last one.
    void check_picture() {
        try {
            picture->check();
        } catch (const DeviceError&) {
            glfwHideWindow(window);
            glfwPollEvents();
            throw;
        }
    }

    void check_place() {
        const std::string problem = misplacement();
        if (!problem.empty()) refuse(problem);
        check_turn();
        check_nothing_above();
    }

    void check_turn() {
        const auto now = std::chrono::steady_clock::now();
        if (now - turn_looked_at < kTurnLooks) return;
        turn_looked_at = now;
        if (output_turn(handle) != turn) refuse("monitor " + monitor.name + " was turned, mirrored or scaled");
    }

    /// What can be raised over is no fault.
    void check_nothing_above() {
        const auto now = std::chrono::steady_clock::now();
        const bool is_above = above->look();
        picture->read_back(!is_above);
        if (!is_above) {
            above_since.reset();
        } else if (!above_since) {
            above_since = now;
            above->raise();
        } else if (now - *above_since > kAboveAllowed) {
            refuse("another window is before the light on monitor " + monitor.name);
        }
    }
};

ProjectorWindow::ProjectorWindow(const std::string& monitor, const Clock& clock, bool allow_only_monitor,
                                 const ProjectorWindowSettings& settings)
    : parts_(std::make_unique<Parts>(monitor, clock, allow_only_monitor, settings)) {}
ProjectorWindow::~ProjectorWindow() = default;

int ProjectorWindow::width() const {
    return parts_->monitor.width;
}
int ProjectorWindow::height() const {
    return parts_->monitor.height;
}
const std::string& ProjectorWindow::monitor() const {
    return parts_->monitor.name;
}
bool ProjectorWindow::dark() const {
    return parts_->picture->dark();
}
void ProjectorWindow::go_dark() noexcept {
    parts_->picture->go_dark();
}

Instant ProjectorWindow::show(const RgbImage& picture, Instant valid_until) {
    if (picture.width != width() || picture.height != height()) {
        go_dark();
        throw DeviceError("Projector window",
                          "a picture of " + std::to_string(picture.width) + "x" + std::to_string(picture.height) +
                              " does not fit the monitor's " + std::to_string(width()) + "x" + std::to_string(height()),
                          "Calibrate the rig at the projector's own resolution, or set the monitor to it.");
    }
    parts_->check_place();
    if (parts_->clock.now() >= valid_until)
        go_dark();
    else
        parts_->picture->show(picture, valid_until);
    return parts_->clock.now() + parts_->settings.light_delay;
}

void ProjectorWindow::refresh() {
    glfwPollEvents();
    parts_->check_picture();
    parts_->check_place();
    if (std::exchange(parts_->damaged, false)) parts_->picture->redraw();
}

}  // namespace planlight
