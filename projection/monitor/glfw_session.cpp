#include "projection/monitor/glfw_session.h"

#include <GLFW/glfw3.h>

#include <utility>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

std::string& stored_error() {
    thread_local std::string error;  // GLFW calls back on the thread that failed
    return error;
}

struct Session {
    Session() {
        glfwSetErrorCallback([](int, const char* text) { stored_error() = text; });
        if (glfwInit() != GLFW_TRUE)
            throw DeviceError("Display", "no window can be opened (" + last_window_error() + ")",
                              "Start the program in a desktop session, or set DISPLAY.");
    }
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;
    ~Session() { glfwTerminate(); }
};

}  // namespace

std::shared_ptr<void> glfw_session() {
    static std::weak_ptr<Session> shared;
    if (auto session = shared.lock()) return session;
    auto session = std::make_shared<Session>();
    shared = session;
    return session;
}

std::string last_window_error() {
    std::string error = std::exchange(stored_error(), {});
    return error.empty() ? "no reason given" : error;
}

}  // namespace planlight
