#pragma once

#include <optional>

struct GLFWmonitor;

namespace planlight {

/// How a picture is laid onto a monitor beside its place and mode: turned, mirrored, scaled. The window system tells
/// none of it when it is asked for the monitor's size.
struct OutputTurn {
    int turned_or_mirrored = 0;  ///< of RandR: rotation and reflection
    int width = 0, height = 0;   ///< of the part of the desktop that it shows
    bool scaled = false;         ///< or warped: a pixel of the desktop is none of the monitor
    bool operator==(const OutputTurn&) const = default;
};

/// As it is now; empty where the window system does not tell (elsewhere than on X11, or the monitor is off).
std::optional<OutputTurn> output_turn(GLFWmonitor* monitor);

}  // namespace planlight
