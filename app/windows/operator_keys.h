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
    landmarks,  ///< opens and closes them
    landmark_undo,
    landmark_turn,
    landmark_use,
    refused_picture,  ///< the picture that a scan was refused for, or the live one again
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
    stay,          ///< so does what leads on: one pedal answers
};

/// Of a key as GLFW names it (`GLFW_KEY_...`).
KeyMeaning meaning_of(int key);

/// How that key is shown in a button: "S"; several with a dot between them.
std::string key_text(KeyMeaning meaning);
/// Of a button: "S", or "S · Enter · PgDn" of the one that leads on.
std::string keys_of_button(KeyMeaning meaning, bool leads_on);

}  // namespace planlight
