#include "app/windows/x11_window_state.h"

#define GLFW_EXPOSE_NATIVE_X11
#include <GLFW/glfw3.h>
#include <GLFW/glfw3native.h>
#include <X11/Xatom.h>

#include <optional>

namespace planlight {
namespace {

/// A property of one number; empty where the window has none.
std::optional<unsigned long> number_of(Display* display, ::Window window, const char* property) {
    const Atom name = XInternAtom(display, property, True);
    if (name == None) return std::nullopt;
    Atom type = None;
    int format = 0;
    unsigned long items = 0, more = 0;
    unsigned char* data = nullptr;
    constexpr int kBits = 32;
    std::optional<unsigned long> number;
    if (XGetWindowProperty(display, window, name, 0, 1, False, XA_CARDINAL, &type, &format, &items, &more, &data) ==
            Success &&
        type == XA_CARDINAL && format == kBits && items == 1)
        number = *reinterpret_cast<unsigned long*>(data);  // Xlib's way to hand over 32 bits
    if (data != nullptr) XFree(data);
    return number;
}

}  // namespace

bool on_other_workspace(GLFWwindow* window) {
    constexpr unsigned long kOnAll = 0xffffffff;
    Display* const display = glfwGetX11Display();
    const ::Window id = display != nullptr ? glfwGetX11Window(window) : 0;
    if (id == 0) return false;
    XWindowAttributes now{};
    if (XGetWindowAttributes(display, id, &now) != 0 && now.map_state != IsViewable) return true;
    const auto on = number_of(display, id, "_NET_WM_DESKTOP");
    if (!on || (*on & kOnAll) == kOnAll) return false;
    const auto shown = number_of(display, DefaultRootWindow(display), "_NET_CURRENT_DESKTOP");
    return shown && *shown != *on;
}

bool keyboard_is_elsewhere(GLFWwindow* window) {
    Display* const display = glfwGetX11Display();
    const ::Window id = display != nullptr ? glfwGetX11Window(window) : 0;
    if (id == 0) return false;
    ::Window focus = None;
    int revert = 0;
    XGetInputFocus(display, &focus, &revert);
    return focus != PointerRoot && focus != id;
}

}  // namespace planlight
