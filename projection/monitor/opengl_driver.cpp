#define GLFW_INCLUDE_GLCOREARB
#define GL_GLEXT_PROTOTYPES
#include "projection/monitor/opengl_driver.h"

#include <GLFW/glfw3.h>

#include "planning_io/types/error.h"
#include "projection/monitor/glfw_session.h"

namespace planlight {

std::string opengl_driver() {
    const auto session = glfw_session();
    glfwDefaultWindowHints();
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
    GLFWwindow* const window = glfwCreateWindow(16, 16, "Planlight", nullptr, nullptr);
    if (window == nullptr)
        throw DeviceError("OpenGL", "no window can be drawn (" + last_window_error() + ")",
                          "Install an OpenGL 3.3 driver, or set LIBGL_ALWAYS_SOFTWARE=1.");
    glfwMakeContextCurrent(window);
    const auto* name = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
    std::string driver = name ? name : "not told";
    glfwMakeContextCurrent(nullptr);
    glfwDestroyWindow(window);
    return driver;
}

}  // namespace planlight
