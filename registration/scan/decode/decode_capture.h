#pragma once

#include <optional>

#include "registration/scan/scan_surface.h"

namespace planlight {

/// The code of a capture's pictures, by whatever of the sequence is there.
struct DecodedCapture {
    DecodedView left;
    std::optional<DecodedView> right;  ///< empty: the capture has no right pictures, or they are not wanted
    double step_px = 0;                ///< as `ScanResult::code_step_px`
};

/// By the fringes; by the Gray code alone where the capture has no fringes, or where they are too fine for the optics:
/// then under 2 % of the lit pixels have them and the Gray code decides more. Throws std::invalid_argument when the
/// pictures are not what the capture says.
DecodedCapture decode_capture(const ScanCapture& capture, bool with_right, const DecodeSettings& settings = {});

}  // namespace planlight
