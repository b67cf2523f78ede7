#include "projection/black_gamma.h"

#include <X11/extensions/Xrandr.h>

#include <algorithm>

#include "projection/x11_pointers.h"

namespace planlight {
namespace {

bool all_zero(const std::vector<unsigned short>& values) {
    return std::all_of(values.begin(), values.end(), [](unsigned short v) { return v == 0; });
}

}  // namespace

std::vector<BlackGamma::Table> BlackGamma::tables_of(const ProjectorOutput& output) const {
    std::vector<Table> tables;
    const X11Pointer<XRRScreenResources, XRRFreeScreenResources> resources(
        XRRGetScreenResourcesCurrent(connection_, DefaultRootWindow(connection_)));
    if (!resources) return tables;
    for (const RROutput id : output.outputs) {
        const X11Pointer<XRROutputInfo, XRRFreeOutputInfo> info(XRRGetOutputInfo(connection_, resources.get(), id));
        if (!info || info->crtc == None) continue;
        const X11Pointer<XRRCrtcGamma, XRRFreeGamma> gamma(XRRGetCrtcGamma(connection_, info->crtc));
        if (!gamma || gamma->size < 2) continue;
        tables.push_back({info->crtc,
                          {gamma->red, gamma->red + gamma->size},
                          {gamma->green, gamma->green + gamma->size},
                          {gamma->blue, gamma->blue + gamma->size}});
    }
    return tables;
}

void BlackGamma::set(const Table& table) const {
    const X11Pointer<XRRCrtcGamma, XRRFreeGamma> gamma(XRRAllocGamma(static_cast<int>(table.red.size())));
    if (!gamma) return;
    std::copy(table.red.begin(), table.red.end(), gamma->red);
    std::copy(table.green.begin(), table.green.end(), gamma->green);
    std::copy(table.blue.begin(), table.blue.end(), gamma->blue);
    XRRSetCrtcGamma(connection_, table.crtc, gamma.get());
}

bool BlackGamma::blacken(const ProjectorOutput& output) {
    if (black()) return true;
    before_ = tables_of(output);
    for (Table table : before_) {
        for (auto* values : {&table.red, &table.green, &table.blue}) std::fill(values->begin(), values->end(), 0);
        set(table);
    }
    XSync(connection_, False);
    return black();
}

void BlackGamma::restore() noexcept {
    for (const Table& table : before_) set(table);
    if (black()) XSync(connection_, False);
    before_.clear();
}

void BlackGamma::mend(const ProjectorOutput& output) {
    for (Table table : tables_of(output)) {
        if (!all_zero(table.red) || !all_zero(table.green) || !all_zero(table.blue)) continue;
        for (auto* values : {&table.red, &table.green, &table.blue})
            for (std::size_t i = 0; i < values->size(); ++i)
                (*values)[i] = static_cast<unsigned short>(0xffff * i / (values->size() - 1));
        set(table);
    }
    XSync(connection_, False);
}

}  // namespace planlight
