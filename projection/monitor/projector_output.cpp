#include "projection/monitor/projector_output.h"

#include <X11/extensions/Xrandr.h>

#include <algorithm>
#include <span>

#include "projection/monitor/x11_pointers.h"

namespace planlight {
namespace {

bool overlap(const XRRMonitorInfo& a, const XRRMonitorInfo& b) {
    return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

}  // namespace

std::optional<ProjectorOutput> projector_output(Display* display, const std::string& name) {
    int count = 0;
    const X11Pointer<XRRMonitorInfo, XRRFreeMonitors> all(
        XRRGetMonitors(display, DefaultRootWindow(display), True, &count));
    if (!all) return std::nullopt;
    const Atom wanted = XInternAtom(display, name.c_str(), True);
    const std::span<const XRRMonitorInfo> monitors(all.get(), static_cast<std::size_t>(std::max(count, 0)));
    const auto found = std::ranges::find_if(monitors, [&](const XRRMonitorInfo& m) { return m.name == wanted; });
    if (found == monitors.end() || monitors.size() < 2 || found->primary != 0 ||
        std::ranges::count_if(monitors, [&](const XRRMonitorInfo& m) { return overlap(m, *found); }) != 1)
        return std::nullopt;
    return ProjectorOutput{
        found->x, found->y, found->width, found->height, {found->outputs, found->outputs + found->noutput}};
}

}  // namespace planlight
