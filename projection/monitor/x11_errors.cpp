#include "projection/monitor/x11_errors.h"

#include <X11/Xlib.h>

#include <mutex>
#include <set>

namespace planlight {
namespace {

struct Forgiven {
    std::mutex mutex;
    std::set<Display*> connections;
    XErrorHandler before = nullptr;
};

Forgiven& forgiven() {
    static Forgiven all;
    return all;
}

int take_error(Display* connection, XErrorEvent* error) {
    Forgiven& all = forgiven();
    const std::unique_lock lock(all.mutex);
    return all.connections.contains(connection) || all.before == nullptr ? 0 : all.before(connection, error);
}

}  // namespace

void forgive_errors_on(Display* connection) {
    Forgiven& all = forgiven();
    const std::lock_guard lock(all.mutex);
    all.connections.insert(connection);
    const XErrorHandler now = XSetErrorHandler(take_error);
    if (now != take_error) all.before = now;
}

void forget_errors_on(Display* connection) {
    Forgiven& all = forgiven();
    const std::lock_guard lock(all.mutex);
    all.connections.erase(connection);
}

}  // namespace planlight
