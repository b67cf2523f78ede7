#pragma once

#include <string>

namespace planlight::test {

/// The name of the window that has the keyboard, as the X server says; empty where none with a name has it.
std::string keyboard_owner();

/// Another program that has the keyboard for as long as this lives, with a window that nobody sees; it goes to the
/// window under the mouse then.
class KeyboardTaken {
public:
    KeyboardTaken();
    ~KeyboardTaken();
    KeyboardTaken(const KeyboardTaken&) = delete;
    KeyboardTaken& operator=(const KeyboardTaken&) = delete;

private:
    void* display_;
};

}  // namespace planlight::test
