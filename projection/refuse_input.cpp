#include "projection/refuse_input.h"

#define GLFW_EXPOSE_NATIVE_X11
#include <GLFW/glfw3.h>
#include <GLFW/glfw3native.h>
#include <X11/Xutil.h>

namespace planlight {

void refuse_input(GLFWwindow* window) {
    Display* const display = glfwGetX11Display();
    const ::Window id = glfwGetX11Window(window);
    if (display == nullptr || id == 0) return;
    XWMHints* const hints = XGetWMHints(display, id);  // those that are set stay
    XWMHints none{};
    XWMHints& wanted = hints != nullptr ? *hints : none;
    wanted.flags |= InputHint;
    wanted.input = False;
    XSetWMHints(display, id, &wanted);
    if (hints != nullptr) XFree(hints);
}

}  // namespace planlight
