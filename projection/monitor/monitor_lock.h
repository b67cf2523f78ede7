#pragma once

#include <string>

namespace planlight {

/// One projector, one master: held by whoever lights a monitor, for the whole machine and all of its users; gone with
/// the process that holds it, however that ends.
class MonitorLock {
public:
    /// Throws DeviceError, with the number of the process that holds it, when another process lights this monitor of
    /// the display already.
    explicit MonitorLock(const std::string& monitor);
    ~MonitorLock();
    MonitorLock(const MonitorLock&) = delete;
    MonitorLock& operator=(const MonitorLock&) = delete;

private:
    int socket_ = -1;
};

}  // namespace planlight
