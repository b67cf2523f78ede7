#pragma once

struct GLFWwindow;

namespace planlight {

/// What the window system is told of a projector's window before it is seen; X11, elsewhere nothing.
///
/// It takes no input (ICCCM 4.1.7): some window managers give each new window the keyboard, and then neither a key nor
/// a pedal reaches DARK. The server itself paints it black where its picture is not there yet. A compositor is asked to
/// leave it alone (EWMH, _NET_WM_BYPASS_COMPOSITOR), for it could move, fade or keep the light.
void set_projector_hints(GLFWwindow* window);

}  // namespace planlight
