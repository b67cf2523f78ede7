#pragma once

#include <memory>
#include <string>

namespace planlight {

/// A black window before a monitor whose projector window is gone: without it the desktop's own picture lies on the
/// patient, while the program says that it is dark. X11; elsewhere nothing. It has a connection of its own; to be used
/// by one thread at a time.
class DarkCover {
public:
    explicit DarkCover(std::string monitor);
    ~DarkCover();
    DarkCover(const DarkCover&) = delete;
    DarkCover& operator=(const DarkCover&) = delete;

    /// Over the monitor as it is now, before all windows; to be called again for it to follow. Never over the primary
    /// monitor, the only one, or one that shows a part of what another shows: the operator's window is there.
    void cover() noexcept;
    void uncover() noexcept;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace planlight
