#pragma once

#include <memory>

struct GLFWwindow;

namespace planlight {

/// Tells whether another window lies before a part of this one, where the window system tells it: X11, and no desktop
/// that composites its windows (there each is called free). It has a connection of its own.
class WindowAbove {
public:
    explicit WindowAbove(GLFWwindow* window);  ///< before the window is first seen
    ~WindowAbove();
    WindowAbove(const WindowAbove&) = delete;
    WindowAbove& operator=(const WindowAbove&) = delete;

    /// By what was told until now.
    bool look();
    /// Asks for the window to be above all others.
    void raise();

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace planlight
