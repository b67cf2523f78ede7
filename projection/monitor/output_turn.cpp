#include "projection/monitor/output_turn.h"

#define GLFW_EXPOSE_NATIVE_X11
#include <GLFW/glfw3.h>
#include <GLFW/glfw3native.h>
#include <X11/extensions/Xrandr.h>

#include "projection/monitor/x11_pointers.h"

namespace planlight {
namespace {

/// True where the transformation is not the identity.
bool is_scaled(Display* display, RRCrtc output) {
    XRRCrtcTransformAttributes* told = nullptr;
    if (XRRGetCrtcTransform(display, output, &told) == 0 || told == nullptr) return false;
    const X11Pointer<XRRCrtcTransformAttributes, XFree> attributes(told);
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            if (attributes->currentTransform.matrix[row][column] != (row == column ? XDoubleToFixed(1) : 0))
                return true;
    return false;
}

}  // namespace

std::optional<OutputTurn> output_turn(GLFWmonitor* monitor) {
    Display* const display = glfwGetX11Display();
    const RRCrtc output = display != nullptr ? glfwGetX11Adapter(monitor) : None;
    if (output == None) return std::nullopt;
    const X11Pointer<XRRScreenResources, XRRFreeScreenResources> resources(
        XRRGetScreenResourcesCurrent(display, DefaultRootWindow(display)));
    if (!resources) return std::nullopt;
    const X11Pointer<XRRCrtcInfo, XRRFreeCrtcInfo> info(XRRGetCrtcInfo(display, resources.get(), output));
    if (!info || info->mode == None) return std::nullopt;
    return OutputTurn{info->rotation, static_cast<int>(info->width), static_cast<int>(info->height),
                      is_scaled(display, output)};
}

}  // namespace planlight
