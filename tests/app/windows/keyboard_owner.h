#pragma once

#include <string>

namespace planlight::test {

/// The name of the window that has the keyboard, as the X server says; empty where none with a name has it.
std::string keyboard_owner();

}  // namespace planlight::test
