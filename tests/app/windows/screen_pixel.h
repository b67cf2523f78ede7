#pragma once

#include <optional>

#include "planning_io/types/time.h"
#include "projection/monitor/projector_window.h"

namespace planlight::test {

/// What a person sees at the middle of a monitor: not what a program says of it. One thread an object.
class ScreenPixel {
public:
    explicit ScreenPixel(const Monitor& monitor);
    ~ScreenPixel();
    ScreenPixel(const ScreenPixel&) = delete;
    ScreenPixel& operator=(const ScreenPixel&) = delete;

    /// 0xRRGGBB.
    unsigned colour() const;
    bool lit() const { return colour() != 0; }
    /// Waits for that colour, for a compositor takes its time; whether it came within `patience`.
    bool shows_soon(unsigned colour, Instant patience = std::chrono::milliseconds(300)) const;
    bool lit_soon(Instant patience = std::chrono::milliseconds(300)) const;
    /// How long until it is dark; empty after `patience`.
    std::optional<Instant> until_dark(Instant patience) const;

private:
    void* display_;
    int x_, y_;
};

}  // namespace planlight::test
