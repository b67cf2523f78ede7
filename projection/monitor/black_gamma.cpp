#include "projection/monitor/black_gamma.h"

#include <X11/extensions/Xrandr.h>

#include <algorithm>

#include "projection/monitor/x11_pointers.h"

namespace planlight {
namespace {

using Resources = X11Pointer<XRRScreenResources, XRRFreeScreenResources>;

Resources resources_of(Display* connection) {
    return Resources(XRRGetScreenResourcesCurrent(connection, DefaultRootWindow(connection)));
}

}  // namespace

bool BlackGamma::Table::all_zero() const {
    const auto zero = [](const std::vector<unsigned short>& values) {
        return std::all_of(values.begin(), values.end(), [](unsigned short v) { return v == 0; });
    };
    return zero(red) && zero(green) && zero(blue);
}

BlackGamma::Table BlackGamma::Table::linear_to(double end) const {
    Table table = *this;
    for (auto* values : {&table.red, &table.green, &table.blue})
        for (std::size_t i = 0; i < values->size(); ++i)
            (*values)[i] = static_cast<unsigned short>(end * 0xffff * static_cast<double>(i) /
                                                       static_cast<double>(values->size() - 1));
    return table;
}

std::vector<RRCrtc> BlackGamma::crtcs_of(const ProjectorOutput& output) const {
    std::vector<RRCrtc> crtcs;
    const Resources resources = resources_of(connection_);
    if (!resources) return crtcs;
    for (const RROutput id : output.outputs) {
        const X11Pointer<XRROutputInfo, XRRFreeOutputInfo> info(XRRGetOutputInfo(connection_, resources.get(), id));
        if (info && info->crtc != None) crtcs.push_back(info->crtc);
    }
    return crtcs;
}

std::vector<RRCrtc> BlackGamma::all_crtcs() const {
    const Resources resources = resources_of(connection_);
    if (!resources) return {};
    return {resources->crtcs, resources->crtcs + resources->ncrtc};
}

std::vector<BlackGamma::Table> BlackGamma::tables_of(const std::vector<RRCrtc>& crtcs) const {
    std::vector<Table> tables;
    for (const RRCrtc crtc : crtcs) {
        const X11Pointer<XRRCrtcGamma, XRRFreeGamma> gamma(XRRGetCrtcGamma(connection_, crtc));
        if (!gamma || gamma->size < 2) continue;
        tables.push_back({crtc,
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
    XSync(connection_, False);
}

bool BlackGamma::blacken(const ProjectorOutput& output) {
    const std::vector<RRCrtc> crtcs = crtcs_of(output);
    const auto left = std::partition(before_.begin(), before_.end(), [&](const Table& table) {
        return std::find(crtcs.begin(), crtcs.end(), table.crtc) != crtcs.end();
    });
    std::for_each(left, before_.end(), [&](const Table& table) { set(table); });
    before_.erase(left, before_.end());
    const auto now = tables_of(crtcs);
    for (const Table& table : now) {
        const bool known =
            std::any_of(before_.begin(), before_.end(), [&](const Table& before) { return before.crtc == table.crtc; });
        if (!known) before_.push_back(table);
        if (!table.all_zero()) set(table.linear_to(0));
    }
    const auto kept = tables_of(crtcs);
    return !kept.empty() && kept.size() == crtcs.size() &&
           std::all_of(kept.begin(), kept.end(), [](const Table& table) { return table.all_zero(); });
}

void BlackGamma::restore() {
    for (const Table& table : before_) set(table);
    before_.clear();
}

void BlackGamma::take_over(const ProjectorOutput& output) {
    const std::vector<RRCrtc> own = crtcs_of(output);
    for (const Table& table : tables_of(all_crtcs())) {
        if (!table.all_zero()) continue;
        if (std::find(own.begin(), own.end(), table.crtc) == own.end())
            set(table.linear_to(1));
        else
            before_.push_back(table.linear_to(1));
    }
}

}  // namespace planlight
