#include "projection/window_above.h"

#define GLFW_EXPOSE_NATIVE_X11
#include <GLFW/glfw3.h>
#include <GLFW/glfw3native.h>
#include <X11/Xlib.h>

namespace planlight {

struct WindowAbove::Parts {
    Display* display = nullptr;
    ::Window window = 0;
    bool above = false;
    ~Parts() {
        if (display != nullptr) XCloseDisplay(display);
    }
};

WindowAbove::WindowAbove(GLFWwindow* window) : parts_(std::make_unique<Parts>()) {
    if (glfwGetX11Display() == nullptr) return;
    XSync(glfwGetX11Display(), False);  // the server knows the window then, also for another connection
    parts_->window = glfwGetX11Window(window);
    parts_->display = XOpenDisplay(DisplayString(glfwGetX11Display()));
    if (parts_->display == nullptr) return;
    XSelectInput(parts_->display, parts_->window, VisibilityChangeMask);
    XSync(parts_->display, False);
}

WindowAbove::~WindowAbove() = default;

bool WindowAbove::look() {
    while (parts_->display != nullptr && XPending(parts_->display) > 0) {
        XEvent event;
        XNextEvent(parts_->display, &event);
        if (event.type == VisibilityNotify) parts_->above = event.xvisibility.state != VisibilityUnobscured;
    }
    return parts_->above;
}

void WindowAbove::raise() {
    if (parts_->display == nullptr) return;
    XRaiseWindow(parts_->display, parts_->window);
    XFlush(parts_->display);
}

}  // namespace planlight
