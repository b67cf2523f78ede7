#pragma once

#include <functional>
#include <string>
#include <vector>

#include "planning_io/types/image.h"
#include "projection/monitor/projector_window.h"

namespace planlight {

/// The picture that tells a person which monitor this is: its name and number in letters as large as fit, size and
/// refresh, model and serial where known, and the question PLANLIGHT PROJECTOR HERE? Lines on black, so that little
/// light comes.
RgbImage draw_monitor_card(const Monitor& monitor, int number);

/// Shows its card on every monitor at once until `seconds` are over or `stop` says so; dark after that. A monitor on
/// which no window lands is left out and comes back with its reason. The pictures expire by themselves, also when the
/// program hangs. Main thread only. Throws DeviceError without a display.
std::vector<std::string> show_monitor_cards(const Clock& clock, double seconds, const std::function<bool()>& stop);

}  // namespace planlight
