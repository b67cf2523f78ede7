#pragma once

#include "app/windows/operator_window.h"

struct GLFWwindow;

namespace planlight {

/// A window with an OpenGL 3.3 context on the monitor that is asked for, shown; the caller destroys it. Throws
/// DeviceError when there is no display, no such monitor or no OpenGL 3.3.
GLFWwindow* open_window(const OperatorWindowSettings& settings);

/// What was painted into the current window and not yet swapped, top row first.
RgbImage read_window(int width, int height);

}  // namespace planlight
