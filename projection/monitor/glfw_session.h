#pragma once

#include <memory>
#include <string>

namespace planlight {

/// The one connection to the window system that all windows of the program share; closed with the last of them.
///
/// To be used from the main thread only. Throws DeviceError when there is no display.
std::shared_ptr<void> glfw_session();

/// What the window system complained of last, and forgets it; "no reason given" when it did not complain.
std::string last_window_error();

}  // namespace planlight
