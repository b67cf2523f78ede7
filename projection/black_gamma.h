#pragma once

#include <X11/extensions/Xrandr.h>

#include <vector>

#include "projection/projector_output.h"

namespace planlight {

/// Makes a monitor black by the gamma tables of its graphics output, which are the X server's: also where a compositor
/// hangs, or a window that nobody can draw in any more stays. One thread.
class BlackGamma {
public:
    /// The connection must outlive it. What is black when it ends stays so.
    explicit BlackGamma(Display* connection) : connection_(connection) {}
    BlackGamma(const BlackGamma&) = delete;
    BlackGamma& operator=(const BlackGamma&) = delete;

    /// False where the output has no such tables. It remembers what was there.
    bool blacken(const ProjectorOutput& output);
    /// As it was before.
    void restore() noexcept;
    bool black() const { return !before_.empty(); }

    /// Where a program that ended left it black: the usual tables again.
    void mend(const ProjectorOutput& output);

private:
    struct Table {
        RRCrtc crtc = None;
        std::vector<unsigned short> red, green, blue;
    };
    std::vector<Table> tables_of(const ProjectorOutput& output) const;
    void set(const Table& table) const;

    Display* connection_;
    std::vector<Table> before_;
};

}  // namespace planlight
