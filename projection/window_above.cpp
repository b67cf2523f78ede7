#include "projection/window_above.h"

#define GLFW_EXPOSE_NATIVE_X11
#include <GLFW/glfw3.h>
#include <GLFW/glfw3native.h>

#include "projection/x11_pointers.h"

namespace planlight {

struct WindowAbove::Parts {
    X11Display connection;
    ::Window window = 0;
    bool above = false;
};

WindowAbove::WindowAbove(GLFWwindow* window) : parts_(std::make_unique<Parts>()) {
    if (glfwGetX11Display() == nullptr) return;
    XSync(glfwGetX11Display(), False);  // the server knows the window then, also for another connection
    parts_->window = glfwGetX11Window(window);
    parts_->connection.reset(XOpenDisplay(DisplayString(glfwGetX11Display())));
    if (!parts_->connection) return;
    XSelectInput(parts_->connection.get(), parts_->window, VisibilityChangeMask);
    XSync(parts_->connection.get(), False);
}

WindowAbove::~WindowAbove() = default;

bool WindowAbove::look() {
    while (parts_->connection && XPending(parts_->connection.get()) > 0) {
        XEvent event;
        XNextEvent(parts_->connection.get(), &event);
        if (event.type == VisibilityNotify) parts_->above = event.xvisibility.state != VisibilityUnobscured;
    }
    return parts_->above;
}

void WindowAbove::raise() {
    if (!parts_->connection) return;
    XRaiseWindow(parts_->connection.get(), parts_->window);
    XFlush(parts_->connection.get());
}

}  // namespace planlight
