#include <X11/Xatom.h>
#include <X11/extensions/Xrandr.h>

#include "projection/monitor/edid.h"
#include "projection/monitor/x11_pointers.h"

namespace planlight {
namespace {

std::vector<std::uint8_t> property_of(Display* display, RROutput output) {
    const Atom edid = XInternAtom(display, "EDID", True);
    if (edid == None) return {};
    Atom type = None;
    int format = 0;
    unsigned long items = 0, more = 0;
    unsigned char* data = nullptr;
    constexpr long kMost = 256;  // of 4 bytes
    if (XRRGetOutputProperty(display, output, edid, 0, kMost, False, False, AnyPropertyType, &type, &format, &items,
                             &more, &data) != Success)
        return {};
    const X11Pointer<unsigned char, XFree> owned(data);
    if (data == nullptr || type != XA_INTEGER || format != 8) return {};
    return {data, data + items};
}

}  // namespace

std::optional<Edid> edid_of_output(const std::string& name) {
    const X11Display display(XOpenDisplay(nullptr));
    int event = 0, error = 0;
    if (!display || XRRQueryExtension(display.get(), &event, &error) == 0) return std::nullopt;
    const X11Pointer<XRRScreenResources, XRRFreeScreenResources> resources(
        XRRGetScreenResourcesCurrent(display.get(), DefaultRootWindow(display.get())));
    if (!resources) return std::nullopt;
    for (int i = 0; i < resources->noutput; ++i) {
        const X11Pointer<XRROutputInfo, XRRFreeOutputInfo> info(
            XRRGetOutputInfo(display.get(), resources.get(), resources->outputs[i]));
        if (info && name == std::string(info->name, static_cast<std::size_t>(info->nameLen)))
            return parse_edid(property_of(display.get(), resources->outputs[i]));
    }
    return std::nullopt;
}

}  // namespace planlight
