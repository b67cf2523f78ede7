#include "app/windows/operator_keys.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace planlight {
namespace {

struct Key {
    int code;
    KeyMeaning meaning;
    const char* shown;  ///< empty: it works and is not shown
};

constexpr Key kKeys[] = {
    {GLFW_KEY_SPACE, KeyMeaning::dark, "Space"},
    {GLFW_KEY_B, KeyMeaning::dark, "B"},
    {GLFW_KEY_ESCAPE, KeyMeaning::dark, "Esc"},
    {GLFW_KEY_PAGE_UP, KeyMeaning::dark, "PgUp"},
    {GLFW_KEY_ENTER, KeyMeaning::next, "Enter"},
    {GLFW_KEY_KP_ENTER, KeyMeaning::next, ""},
    {GLFW_KEY_PAGE_DOWN, KeyMeaning::next, "PgDn"},
    {GLFW_KEY_S, KeyMeaning::scan, "S"},
    {GLFW_KEY_R, KeyMeaning::do_register, "R"},
    {GLFW_KEY_T, KeyMeaning::track, "T"},
    {GLFW_KEY_X, KeyMeaning::stop, "X"},
    {GLFW_KEY_C, KeyMeaning::confirm, "C"},
    {GLFW_KEY_K, KeyMeaning::check_skin, "K"},
    {GLFW_KEY_L, KeyMeaning::landmarks, "L"},
    {GLFW_KEY_U, KeyMeaning::landmark_undo, "U"},
    {GLFW_KEY_Q, KeyMeaning::landmark_turn, "Q"},
    {GLFW_KEY_M, KeyMeaning::landmark_use, "M"},
    {GLFW_KEY_P, KeyMeaning::refused_picture, "P"},
    {GLFW_KEY_E, KeyMeaning::evidence, "E"},
    {GLFW_KEY_1, KeyMeaning::before, "1"},
    {GLFW_KEY_2, KeyMeaning::after, "2"},
    {GLFW_KEY_3, KeyMeaning::error, "3"},
    {GLFW_KEY_V, KeyMeaning::views, "V"},
    {GLFW_KEY_F1, KeyMeaning::view_front, "F1"},
    {GLFW_KEY_F2, KeyMeaning::view_back, "F2"},
    {GLFW_KEY_F3, KeyMeaning::view_above, "F3"},
    {GLFW_KEY_F4, KeyMeaning::view_right, "F4"},
    {GLFW_KEY_F5, KeyMeaning::view_left, "F5"},
    {GLFW_KEY_F6, KeyMeaning::view_reset, "F6"},
    {GLFW_KEY_F7, KeyMeaning::view_projector, "F7"},
    {GLFW_KEY_F8, KeyMeaning::view_surgeon, "F8"},
    {GLFW_KEY_I, KeyMeaning::next_item, "I"},
    {GLFW_KEY_0, KeyMeaning::all_items, "0"},
    {GLFW_KEY_UP, KeyMeaning::row_above, "↑"},
    {GLFW_KEY_DOWN, KeyMeaning::row_below, "↓"},
    {GLFW_KEY_H, KeyMeaning::hide_item, "H"},
    {GLFW_KEY_Y, KeyMeaning::close_window, "Y"},
    {GLFW_KEY_N, KeyMeaning::stay, "N"},
};

}  // namespace

KeyMeaning meaning_of(int key) {
    for (const Key& known : kKeys)
        if (known.code == key) return known.meaning;
    return KeyMeaning::none;
}

std::string key_text(KeyMeaning meaning) {
    std::string text;
    for (const Key& known : kKeys)
        if (known.meaning == meaning && *known.shown != '\0')
            text += (text.empty() ? "" : " · ") + std::string(known.shown);
    return text;
}

std::string keys_of_button(KeyMeaning meaning, bool leads_on) {
    return key_text(meaning) + (leads_on ? " · " + key_text(KeyMeaning::next) : "");
}

}  // namespace planlight
