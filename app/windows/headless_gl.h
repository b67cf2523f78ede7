#pragma once

#include <memory>

namespace planlight {

/// An OpenGL 3.3 context without display or window (EGL, surfaceless), current on the thread that made it until it
/// ends. A thread that already has a context of another kind cannot have one. Throws DeviceError when there is no EGL,
/// and an Error (exit 7) when memory is short for it.
std::shared_ptr<void> headless_gl(int width, int height);

}  // namespace planlight
