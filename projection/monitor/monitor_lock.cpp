#include "projection/monitor/monitor_lock.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <cstring>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

/// ":0" of ":0.0": the screens of a display share their monitors.
std::string display_name() {
    const char* const display = std::getenv("DISPLAY");
    std::string name = display == nullptr ? "" : display;
    if (const auto screen = name.find('.', name.rfind(':') == std::string::npos ? 0 : name.rfind(':'));
        screen != std::string::npos)
        name.resize(screen);
    return name;
}

/// A name in Linux' abstract socket space: no file that could be left behind.
socklen_t address_of(const std::string& monitor, sockaddr_un& address) {
    address = {};
    address.sun_family = AF_UNIX;
    const std::string name = "planlight-light-of " + display_name() + " " + monitor;
    const std::size_t length = std::min(name.size(), sizeof address.sun_path - 1);
    std::memcpy(address.sun_path + 1, name.data(), length);
    return static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + length);
}

/// The process that listens at that address; 0 when it does not say.
pid_t holder_of(const sockaddr_un& address, socklen_t length) {
    const int asking = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (asking < 0) return 0;
    ucred who{};
    socklen_t size = sizeof who;
    if (connect(asking, reinterpret_cast<const sockaddr*>(&address), length) != 0 ||
        getsockopt(asking, SOL_SOCKET, SO_PEERCRED, &who, &size) != 0)
        who.pid = 0;
    close(asking);
    return who.pid;
}

}  // namespace

MonitorLock::MonitorLock(const std::string& monitor) : socket_(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address;
    const socklen_t length = address_of(monitor, address);
    if (socket_ >= 0 && bind(socket_, reinterpret_cast<const sockaddr*>(&address), length) == 0 &&
        listen(socket_, 1) == 0)
        return;
    const int reason = errno;
    if (socket_ >= 0) close(socket_);
    socket_ = -1;
    if (reason != EADDRINUSE)
        throw DeviceError("Projector window", std::string("the monitor cannot be reserved: ") + std::strerror(reason),
                          "Restart the computer, or report this.");
    const pid_t holder = holder_of(address, length);
    throw DeviceError("Projector window",
                      "the light of monitor " + monitor + " is in the hands of another Planlight already" +
                          (holder > 0 ? " (process " + std::to_string(holder) + ")" : ""),
                      "End that session first: two programs must never light one patient.");
}

MonitorLock::~MonitorLock() {
    if (socket_ >= 0) close(socket_);
}

}  // namespace planlight
