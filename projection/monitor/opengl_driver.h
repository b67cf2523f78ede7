#pragma once

#include <string>

namespace planlight {

/// What draws the windows of this display ("llvmpipe ..." is software), by a window that is never seen. To be called
/// from the main thread. Throws DeviceError without a display or without OpenGL 3.3.
std::string opengl_driver();

}  // namespace planlight
