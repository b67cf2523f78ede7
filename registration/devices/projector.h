#pragma once

#include "planning_io/types/image.h"
#include "planning_io/types/time.h"

namespace planlight {

/// Light for the patient. A picture carries its expiry: past that moment the projector is dark by itself.
class Projector {
public:
    virtual ~Projector() = default;

    virtual int width() const = 0;
    virtual int height() const = 0;

    /// Shows a picture of exactly width x height until `valid_until`, then darkness.
    ///
    /// Returns the moment from which the whole picture is light on the patient (delay of display and lamp included):
    /// an exposure that begins at or after it sees the picture. Throws DeviceError when the picture cannot be shown or
    /// has another size; the projector is dark then.
    virtual Instant show(const RgbImage& picture, Instant valid_until) = 0;

    virtual void go_dark() noexcept = 0;
};

/// Darkness on every way out of a scope.
struct DarkOnExit {
    Projector& projector;
    explicit DarkOnExit(Projector& p) : projector(p) {}
    DarkOnExit(const DarkOnExit&) = delete;
    DarkOnExit& operator=(const DarkOnExit&) = delete;
    ~DarkOnExit() { projector.go_dark(); }
};

}  // namespace planlight
