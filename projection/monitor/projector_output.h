#pragma once

#include <X11/extensions/Xrandr.h>

#include <optional>
#include <string>
#include <vector>

namespace planlight {

/// A monitor that is the projector's alone.
struct ProjectorOutput {
    int x = 0, y = 0, width = 0, height = 0;
    std::vector<RROutput> outputs;
};

/// The monitor of that name, of now. Empty where there is none, and where it must not be covered or made black, for the
/// operator's window may be there: it is the primary or the only one, or shows a part of another.
std::optional<ProjectorOutput> projector_output(Display* display, const std::string& name);

}  // namespace planlight
