#pragma once

#include <utility>

namespace planlight {

/// What was pressed on a page between two of its frames. `Action` has `none` and `dark`.
///
/// DARK is taken from the events themselves, so that a press shorter than a frame is not lost, and comes before
/// whatever else was pressed: a window that was busy takes both at once, and no light may follow darkness.
template <typename Action>
class PageInput {
public:
    /// Of a key, as it goes down.
    void press(Action action) {
        if (action == Action::dark)
            dark_ = true;
        else if (action != Action::none)
            pressed_ = action;
    }
    /// Whether DARK was pressed since it was asked last; then all else is forgotten.
    bool take_dark() {
        if (!std::exchange(dark_, false)) return false;
        pressed_ = Action::none;
        return true;
    }
    /// Something other than DARK waits to be taken.
    bool waits() const { return pressed_ != Action::none; }
    Action take() { return std::exchange(pressed_, Action::none); }

private:
    Action pressed_ = Action::none;
    bool dark_ = false;
};

}  // namespace planlight
