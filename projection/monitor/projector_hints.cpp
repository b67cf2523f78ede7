#include "projection/monitor/projector_hints.h"

#define GLFW_EXPOSE_NATIVE_X11
#include <GLFW/glfw3.h>
#include <GLFW/glfw3native.h>
#include <X11/Xatom.h>
#include <X11/Xutil.h>

namespace planlight {
namespace {

void refuse_input(Display* display, ::Window window) {
    XWMHints* const hints = XGetWMHints(display, window);  // those that are set stay
    XWMHints none{};
    XWMHints& wanted = hints != nullptr ? *hints : none;
    wanted.flags |= InputHint;
    wanted.input = False;
    XSetWMHints(display, window, &wanted);
    if (hints != nullptr) XFree(hints);
}

}  // namespace

void set_projector_hints(GLFWwindow* window) {
    constexpr int kBits = 32;
    constexpr unsigned long kNoCompositing = 1;
    Display* const display = glfwGetX11Display();
    const ::Window id = display != nullptr ? glfwGetX11Window(window) : 0;
    if (id == 0) return;
    refuse_input(display, id);
    XSetWindowBackground(display, id, BlackPixel(display, DefaultScreen(display)));
    XChangeProperty(display, id, XInternAtom(display, "_NET_WM_BYPASS_COMPOSITOR", False), XA_CARDINAL, kBits,
                    PropModeReplace, reinterpret_cast<const unsigned char*>(&kNoCompositing), 1);
}

}  // namespace planlight
