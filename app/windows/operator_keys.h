#pragma once

#include <string>

namespace planlight {

/// Every key of the operator window, in one place: a foot pedal is a keyboard to the system.
enum class KeyMeaning {
    none,
    dark,
    next,  ///< the press that leads on
    scan,
    do_register,
    track,
    stop,
    confirm,
    check_skin,
    landmarks,
    evidence,
    before,
    after,
    error,
    views,  ///< opens and closes the buttons of the views
    view_front,
    view_back,
    view_right,
    view_left,
    view_above,
    view_projector,
    view_surgeon,
    view_reset,
    next_item,  ///< the next item of the plan alone is bright
    all_items,  ///< all of the plan is, and nothing of it is hidden
    row_above,  ///< another row of the plan is marked
    row_below,
    hide_item,     ///< the marked row is hidden, or shown again
    close_window,  ///< while that is asked
    stay,
};

/// Of a key as GLFW names it (`GLFW_KEY_...`).
KeyMeaning meaning_of(int key);

/// How that key is shown in a button: "S"; several with a dot between them.
std::string key_text(KeyMeaning meaning);

}  // namespace planlight
