#pragma once

#include <array>
#include <optional>
#include <vector>

#include "registration/projector_measurement/light_recording.h"

namespace planlight {

/// Light for one grey of the picture: 0 = black, 1 = white.
struct ResponsePoint {
    int grey = 0;
    double light = 0, sigma = 0;  ///< sigma: one standard deviation of `light`
    std::size_t frames = 0;
};

/// What the projector makes of the numbers of a picture.
struct ResponseResult {
    std::optional<LightRefusal> refusal;
    std::vector<ResponsePoint> curve;               ///< rising greys
    double gamma = 0, gamma_sigma = 0;              ///< light = ((grey - dark_end) / (bright_end - dark_end))^gamma
    double dark_end = 0, dark_end_sigma = 0;        ///< grey up to which all is black, 0 to 255
    double bright_end = 255, bright_end_sigma = 0;  ///< grey from which all is white
    bool crushes_darks = false, crushes_whites = false;  ///< an end is off by more than two greys and three sigma
    double worst_departure = 0;                          ///< of the curve from the fitted one, share of white
    std::vector<int> not_rising;  ///< greys that are darker than the one before, by more than three sigma
    /// Light of pure red, green and blue, share of white's as this camera sees it; empty: not shown.
    std::optional<std::array<double, 3>> colours;
    std::array<double, 3> colour_sigmas{};
    /// Light of black by white's: the projector's own where the lid was put before the lens, else the room's lamps with
    /// it.
    double black_level = 0, black_level_sigma = 0;
    bool black_level_is_a_bound = true;  ///< the room's light is in it
    double white_drift = 0;     ///< of white between the references beyond noise, share of it, largest from the mean
    double cameras_differ = 0;  ///< largest difference between the curves of the two cameras; 0: one camera
    double black_grey = 0, white_grey = 0;  ///< in the cameras' pictures, mean over the tiles used
    std::size_t tiles = 0, saturated_tiles = 0, tiles_at_zero = 0;
};

/// From steady frames of greys with black and white among them.
///
/// Every grey is set against the black and the white shown around it, tile sums over both cameras: unevenness of
/// camera, light and skin cancels, steady room light too, slow drift as well. The curve is fitted by
/// Levenberg-Marquardt. The cameras must be linear; where they are not, red, green and blue add up to more than white.
/// Refused: nothing of the projector seen, all of it saturated, too few greys.
ResponseResult measure_response(const LightRecording& recording);

}  // namespace planlight
