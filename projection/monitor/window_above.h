#pragma once

#include <memory>

struct GLFWwindow;

namespace planlight {

/// Tells whether another window lies before a part of this one (X11; elsewhere each is called free): by what the window
/// system says is seen of it, and on a desktop that composites its windows, where that is always all of it, by their
/// order. What a compositor itself draws over all windows and lets the mouse through, a message say, it does not know.
/// It has a connection of its own.
class WindowAbove {
public:
    explicit WindowAbove(GLFWwindow* window);  ///< before the window is first seen
    ~WindowAbove();
    WindowAbove(const WindowAbove&) = delete;
    WindowAbove& operator=(const WindowAbove&) = delete;

    /// By what was told until now; the order is asked for 50 times a second.
    bool look();
    /// Asks for the window to be above all others.
    void raise();

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace planlight
