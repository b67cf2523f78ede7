#pragma once

#include <functional>
#include <memory>

#include "app/windows/fonts.h"
#include "app/windows/pen.h"
#include "app/windows/window_settings.h"
#include "planning_io/types/image.h"

namespace planlight {

/// Told of presses as they happen, so that one that is shorter than a frame is not lost. Each may be empty.
struct WindowListener {
    std::function<void(int key, int modifiers)> key;        ///< GLFW_KEY_..., pressed, not repeated
    std::function<void(double x, double y)> mouse_pressed;  ///< any button, window pixels from the top left
    std::function<void(int key)> key_held = {};             ///< again and again, as the system repeats a key
};

/// A window that Dear ImGui draws over OpenGL 3.3: its context, its fonts, its pictures. All members are called from
/// the main thread.
class GuiWindow {
public:
    /// Throws DeviceError when there is no display, no such monitor, no OpenGL 3.3, or no font.
    GuiWindow(const WindowSettings& settings, WindowListener listener);
    ~GuiWindow();
    GuiWindow(const GuiWindow&) = delete;
    GuiWindow& operator=(const GuiWindow&) = delete;

    /// Takes in what was done; waits for it, `longest_s` at most (0: not at all).
    void take_input(double longest_s);
    /// Something was pressed, moved, resized or uncovered since the frame before the last one: then what stands in the
    /// window may have to change.
    bool touched() const;

    using Draw = std::function<void(const Pen& pen, float width, float height)>;
    /// Draws anew over the whole window. Does nothing while the window has no size.
    void frame(const Draw& draw);

    /// What the last frame showed.
    RgbImage screenshot();

    /// No button answers to what the mouse has begun or done so far: after DARK. Draws nothing.
    void forget_presses();

    void make_current();
    bool asked_to_close() const;
    bool put_away() const;  ///< minimised, or on another workspace, as the window system tells it: nobody sees it
    bool keyboard_is_elsewhere() const;  ///< no key reaches the window
    void keep_open();                    ///< forgets that it was asked to close
    const FontFiles& font_files() const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace planlight
