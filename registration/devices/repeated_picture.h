#pragma once

#include <cstdint>
#include <optional>

#include "planning_io/types/image.h"

namespace planlight {

/// Tells a picture that was sent before from a new one, whatever its time says. A sensor's noise makes no two pictures
/// alike to the last bit; a driver that hangs, or a pipeline that fills up a rate (GStreamer's `videorate`), sends one
/// again under a new time, and light would follow a head that has moved since.
class RepeatedPicture {
public:
    /// Whether `picture` is the one before it, bit for bit. A picture of one grey but for a pixel of a thousand (a
    /// covered lens with hot pixels, a sensor at its end) is never told to be one: it may be new.
    bool is(const GrayImage& picture);
    void forget() { last_.reset(); }

private:
    std::optional<std::uint64_t> last_;
};

}  // namespace planlight
