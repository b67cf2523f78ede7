#pragma once

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "registration/simulation/serve/served_camera.h"

namespace planlight::test {

inline simulation::ServedCameraSettings small_camera() {
    simulation::ServedCameraSettings settings;
    settings.serial = "T-17";
    settings.width = 64;
    settings.height = 48;
    settings.exposure = std::chrono::milliseconds(8);
    return settings;
}

/// The cameras' address is this machine's only one: tests that run side by side take turns.
class OneAtATime {
public:
    OneAtATime() : file_(open("/tmp/planlight-served-camera.lock", O_CREAT | O_RDWR, 0666)) { flock(file_, LOCK_EX); }
    ~OneAtATime() { close(file_); }
    OneAtATime(const OneAtATime&) = delete;
    OneAtATime& operator=(const OneAtATime&) = delete;

private:
    int file_;
};

}  // namespace planlight::test
