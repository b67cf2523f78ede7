#pragma once

#include <X11/extensions/Xrandr.h>

#include <vector>

#include "projection/monitor/projector_output.h"

namespace planlight {

/// Makes a monitor black by the gamma tables of its graphics output, which are the X server's: also where a compositor
/// hangs, or a window that nobody can draw in any more stays. Whether the output obeys them nobody can tell: some
/// (over USB, say) have none that count. One thread.
class BlackGamma {
public:
    /// The connection must outlive it. What is black when it ends stays so.
    explicit BlackGamma(Display* connection) : connection_(connection) {}
    BlackGamma(const BlackGamma&) = delete;
    BlackGamma& operator=(const BlackGamma&) = delete;

    /// To be called at every look while it should be black: another program may have set a table of its own since, or
    /// the monitor may be on another of the graphics card's outputs (then the one before gets its own back). False
    /// where there are no tables, or they do not keep what is set.
    bool blacken(const ProjectorOutput& output);
    /// As it was before.
    void restore();
    bool black() const { return !before_.empty(); }

    /// Outputs that a program which ended left black: that one stays so, with the usual table as what it was before;
    /// all others have the usual one again.
    void take_over(const ProjectorOutput& output);

private:
    struct Table {
        RRCrtc crtc = None;
        std::vector<unsigned short> red, green, blue;

        bool all_zero() const;
        Table linear_to(double end) const;  ///< of full light
    };
    std::vector<RRCrtc> crtcs_of(const ProjectorOutput& output) const;
    std::vector<RRCrtc> all_crtcs() const;
    std::vector<Table> tables_of(const std::vector<RRCrtc>& crtcs) const;
    void set(const Table& table) const;

    Display* connection_;
    std::vector<Table> before_;
};

}  // namespace planlight
