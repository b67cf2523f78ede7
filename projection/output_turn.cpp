#include "projection/output_turn.h"

#define GLFW_EXPOSE_NATIVE_X11
#include <GLFW/glfw3.h>
#include <GLFW/glfw3native.h>
#include <X11/extensions/Xrandr.h>

namespace planlight {
namespace {

/// True where the transformation is not the identity.
bool is_scaled(Display* display, RRCrtc output) {
    XRRCrtcTransformAttributes* attributes = nullptr;
    if (XRRGetCrtcTransform(display, output, &attributes) == 0 || attributes == nullptr) return false;
    bool scaled = false;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            scaled =
                scaled || attributes->currentTransform.matrix[row][column] != (row == column ? XDoubleToFixed(1) : 0);
    XFree(attributes);
    return scaled;
}

}  // namespace

std::optional<OutputTurn> output_turn(GLFWmonitor* monitor) {
    Display* const display = glfwGetX11Display();
    const RRCrtc output = display != nullptr ? glfwGetX11Adapter(monitor) : None;
    if (output == None) return std::nullopt;
    XRRScreenResources* const resources =
        XRRGetScreenResourcesCurrent(display, RootWindow(display, DefaultScreen(display)));
    if (resources == nullptr) return std::nullopt;
    XRRCrtcInfo* const info = XRRGetCrtcInfo(display, resources, output);
    XRRFreeScreenResources(resources);
    if (info == nullptr) return std::nullopt;
    OutputTurn turn{info->rotation, static_cast<int>(info->width), static_cast<int>(info->height), false};
    const bool is_on = info->mode != None;
    XRRFreeCrtcInfo(info);
    if (!is_on) return std::nullopt;
    turn.scaled = is_scaled(display, output);
    return turn;
}

}  // namespace planlight
