#pragma once

struct GLFWwindow;

namespace planlight {

/// Tells the window manager that this window, not yet seen, takes no input (ICCCM 4.1.7): some managers give each new
/// window the keyboard, and then neither a key nor a pedal reaches DARK. X11; elsewhere nothing.
void refuse_input(GLFWwindow* window);

}  // namespace planlight
