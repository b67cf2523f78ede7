#pragma once

#include <atomic>
#include <string>
#include <vector>

namespace planlight::test {

/// Presses DARK's key again and again at random moments, in a thread of its own while the caller's loop draws the
/// window of that title, and looks at one pixel of the screen, of the banner, until it has another colour. The loop
/// sets `dark` where it was asked to be dark; this sets it back once the banner was seen. For each press the time to
/// the first look that finds the banner changed, ms; one that changed nothing in two seconds is as long as that. Throws
/// std::runtime_error without a display or a window.
std::vector<double> dark_key_to_banner_ms(const std::string& title, int x, int y, int presses, std::atomic<bool>& dark);

}  // namespace planlight::test
