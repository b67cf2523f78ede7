#pragma once

#include <array>
#include <memory>
#include <string>

#include "app/windows/review_model.h"
#include "app/windows/window_settings.h"

namespace planlight {

/// The window in which a recorded session is gone through. All members are called from the main thread.
///
/// Left and right: frame by frame (held: on and on); up and down, or Page Up and Page Down: event by event; Home, End;
/// the mouse on the time line: to that moment, and its wheel frame by frame; a press on a picture or the head: the
/// place of the plan there. Z: the whole pictures, or round the plan; V: the head, or the projector's picture; S: a
/// picture of the window is wanted; Q or Escape closes it.
class ReviewWindow {
public:
    /// Throws DeviceError when there is no display, no OpenGL 3.3, or no font.
    explicit ReviewWindow(const WindowSettings& settings = {});
    ~ReviewWindow();

    /// Draws the model, where something is new, and says what the person wants.
    ReviewWish frame(const std::shared_ptr<const ReviewModel>& model);

    /// Waits until the person does something, `longest_s` at most.
    void rest(double longest_s);

    /// What the last frame showed.
    RgbImage screenshot();

    /// Where a control stands, x, y, width, height: "time line", "left", "right", "head", and the buttons by their
    /// words.
    std::array<int, 4> place_of(const std::string& control) const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace planlight
