#pragma once

struct GLFWwindow;

namespace planlight {

/// Whether the window manager shows another workspace than the one that this window is on: the window is not viewable,
/// or the two say so (EWMH, `_NET_CURRENT_DESKTOP` and `_NET_WM_DESKTOP`). Where each monitor has workspaces of its
/// own the one that has the keyboard counts: no key reaches the window then either. False on a window that is on all of
/// them, and elsewhere than on X11.
bool on_other_workspace(GLFWwindow* window);

/// Whether another window has the keyboard, so that no key or pedal reaches this one. False where the keyboard goes to
/// the window under the mouse, and elsewhere than on X11.
bool keyboard_is_elsewhere(GLFWwindow* window);

}  // namespace planlight
