#pragma once

#include "tests/registration/scan/scan_figures.h"

// Whether the scatter of a scan about the true skin is its own, or the skin's detail that it averages over.
namespace planlight::scan_rooms {

/// All over the same points: kept, facing the light at less than 65 degrees, off the stickers, with lit skin in all 9 x
/// 9 pixels of the left camera round them. Scatter: rms about its mean in cubes of 4 mm.
struct FootprintFigures {
    std::size_t points = 0;
    double at_point_mm = 0;   ///< scatter of the distance to the true skin at the point's own pixel
    double by_lens_mm = 0;    ///< to the true skin averaged as the camera's lens and pixel do (Gaussian, sigma 0.7 px)
    double by_window_mm = 0;  ///< to that, and fitted by a quadric over 5 x 5 pixels, as the scan does
    double repeat_mm =
        0;  ///< rms difference of two scans of the same room along the normal, by sqrt 2: the scan's own noise
    std::size_t repeated = 0;  ///< points of both scans
};

/// `again` is another scan of the same room at rest; `at` the moment of the first.
FootprintFigures footprint_figures(const ScanResult& scan, const ScanResult& again,
                                   const simulation::SimulatedRig& room, const RigCalibration& rig, Instant at);

}  // namespace planlight::scan_rooms
