#pragma once

#include <X11/Xlib.h>

namespace planlight {

/// From now on errors on that connection count for nothing, where Xlib would end the program: other programs' windows
/// and monitors may be gone at any moment. Whoever asks looks at what comes back. Errors on other connections go where
/// they went before. To be called again before requests that may fail, for a library (GLFW) may have put back a handler
/// meanwhile. From any thread.
void forgive_errors_on(Display* connection);

/// Before that connection is closed.
void forget_errors_on(Display* connection);

}  // namespace planlight
