#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "planning_io/types/light_order.h"
#include "planning_io/types/time.h"
#include "registration/devices/stereo_camera.h"

namespace planlight {

/// One exposure of both cameras, as the mean brightness of tiles.
struct FrameBrightness {
    Instant at{};              ///< mid-exposure
    Instant exposure{};        ///< how long the shutter was open
    std::uint64_t number = 0;  ///< of the cameras; a jump is a lost frame
    std::vector<float>
        tiles;  ///< grey; `kTilesAcross` x `kTilesDown` of the left picture, rows from the top, then of the right
    std::vector<float> saturated;  ///< share of each tile's pixels at 254 or more
    std::vector<float> at_zero;    ///< share of each tile's pixels at 0

    Instant opened() const { return at - exposure / 2; }
    Instant closed() const { return at - exposure / 2 + exposure; }
};

/// The camera's picture in tiles, of which only the mean brightness is kept.
constexpr int kTilesAcross = 16, kTilesDown = 12, kTiles = kTilesAcross * kTilesDown;

/// The tiles of one frame. `right` may be empty (one camera): its tiles are missing then.
FrameBrightness brightness_of(const StereoFrame& frame);

/// Orders and what was seen meanwhile, both in time and on one clock. Of the pictures only the brightness is kept.
struct LightRecording {
    Instant settle = std::chrono::milliseconds(250);  ///< after an order, before its light is taken as steady
    std::vector<LightOrder> orders;
    std::vector<FrameBrightness> frames;
};

/// For every order the frames that saw nothing but its steady light: exposed from `settle` after it to the next order.
std::vector<std::vector<std::size_t>> steady_frames(const LightRecording& recording);

/// Why there is no answer, and what to do.
struct LightRefusal {
    std::string reason, remedy;
};

/// The tiles on which the projector is seen, and how bright they are when it is white and when it is black.
struct LitTiles {
    std::vector<std::size_t> tiles;
    double black = 0, white = 0;  ///< grey, mean over `tiles`
    double noise = 0;             ///< standard deviation of that mean from frame to frame, grey (flicker included)
    std::size_t saturated = 0;    ///< left out: white is at the end of their scale
    std::size_t at_zero = 0;      ///< kept, but the camera's zero cuts off their darks
    std::optional<LightRefusal> refusal;  ///< nothing seen, or all of it saturated; `tiles` is empty then
};

/// The tiles in which white and black light differ; `refusal` where nothing can be told.
LitTiles find_lit_tiles(const LightRecording& recording);

/// The same from flashes, by the darker and the brighter half of the frames, each by its median: does not need to know
/// the delay.
LitTiles find_flashing_tiles(const LightRecording& recording);

/// Mean over some tiles, grey.
double mean_of(const FrameBrightness& frame, const std::vector<std::size_t>& tiles);

/// Time between frames that followed each other, and how many were lost: gaps in which no order was given.
struct FrameTiming {
    double interval_s = 0;              ///< mean over all that fit the median; 0 with fewer than three frames
    std::size_t lost = 0, doubled = 0;  ///< doubled: one number or one moment twice
};

/// By the frames' times and numbers.
FrameTiming frame_timing(const LightRecording& recording);

}  // namespace planlight
