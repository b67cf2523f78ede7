#define GLFW_INCLUDE_GLCOREARB
#define GL_GLEXT_PROTOTYPES
#include "app/windows/open_window.h"

#include <GLFW/glfw3.h>

#include <algorithm>

#include "planning_io/types/error.h"
#include "projection/glfw_session.h"
#include "projection/projector_window.h"

namespace planlight {
namespace {

constexpr int kLeastWidth = 1280, kLeastHeight = 800;

Monitor monitor_for(const OperatorWindowSettings& settings) {
    const std::vector<Monitor> monitors = list_monitors();
    for (std::size_t i = 0; i < monitors.size(); ++i)
        if (settings.monitor ? monitors[i].name == *settings.monitor || std::to_string(i) == *settings.monitor
                             : monitors[i].primary)
            return monitors[i];
    if (settings.monitor || monitors.empty())
        throw DeviceError("Operator window", "there is no monitor \"" + settings.monitor.value_or("primary") + "\"",
                          "Name one of those that `planlight projector --identify` shows.");
    return monitors.front();
}

}  // namespace

GLFWwindow* open_window(const OperatorWindowSettings& settings) {
    const Monitor monitor = monitor_for(settings);
    glfwDefaultWindowHints();
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_AUTO_ICONIFY, GLFW_FALSE);
    glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
    glfwWindowHint(GLFW_DECORATED, settings.fill_monitor ? GLFW_FALSE : GLFW_TRUE);
    const int width =
        settings.fill_monitor ? monitor.width : std::max(std::min(settings.width, monitor.width), kLeastWidth);
    const int height =
        settings.fill_monitor ? monitor.height : std::max(std::min(settings.height, monitor.height), kLeastHeight);
    GLFWwindow* const window = glfwCreateWindow(width, height, settings.title.c_str(), nullptr, nullptr);
    if (window == nullptr)
        throw DeviceError("Operator window", "it could not be opened (" + last_window_error() + ")",
                          "Install an OpenGL 3.3 driver, or set LIBGL_ALWAYS_SOFTWARE=1.");
    glfwSetWindowPos(window, monitor.x + std::max(0, (monitor.width - width) / 2),
                     monitor.y + std::max(0, (monitor.height - height) / 2));
    glfwShowWindow(window);
    glfwSetWindowSizeLimits(window, kLeastWidth, kLeastHeight, GLFW_DONT_CARE, GLFW_DONT_CARE);
    return window;
}

RgbImage read_window(int width, int height) {
    RgbImage upside_down(width, height), picture(width, height);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadBuffer(GL_BACK);
    glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, upside_down.pixels.data());
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) picture.at(x, y) = upside_down.at(x, height - 1 - y);
    return picture;
}

}  // namespace planlight
