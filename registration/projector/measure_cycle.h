#pragma once

#include <optional>
#include <string>
#include <vector>

#include "registration/projector/light_recording.h"

namespace planlight {

struct CycleSettings {
    double refresh_hz = 60;  ///< of the projector; cycles of colour wheels are small multiples of it
    double noticed = 0.005;  ///< share of the light (standard deviation); less is called steady
};

/// How one steady picture varied from frame to frame, beyond noise.
struct CycleRun {
    std::string name;  ///< black, white, red, green, blue
    std::size_t frames = 0;
    double light_grey = 0;       ///< brighter than black, mean over the tiles; for black: its own brightness
    double variation_grey = 0;   ///< standard deviation, noise and slow drift taken out
    double variation = 0;        ///< share of `light_grey`; what the room's lamps vary taken out but for black
    double variation_sigma = 0;  ///< one standard deviation of `variation`
    double at_most = 0;          ///< 95 % bound of `variation`, also when nothing was noticed
    bool varies = false;         ///< beyond noise, and more than `CycleSettings::noticed`
    std::optional<double>
        seen_hz;  ///< as the frames see it (aliased into half the frame rate); empty: no one frequency stands out
    std::vector<double> cycles_hz;  ///< usual cycles that look like that; one: told; several: cannot be told apart
    std::vector<float> trace;       ///< frame by frame, share of `light_grey` about 0
};

/// Room and projector apart.
struct CycleResult {
    std::optional<LightRefusal> refusal;
    std::vector<CycleRun> runs;  ///< one a colour; black is the room
    double frames_hz = 0, exposure_s = 0;
    std::vector<double> unseen_hz;  ///< usual cycles that these frames cannot see: whole multiples of their rate
    bool room_varies = false, projector_varies = false;
    double worst = 0;              ///< largest variation of the projector over the colours, share of light
    double exposure_to_set_s = 0;  ///< the shortest, not under the present one, of whole cycles; 0: nothing to cure
    bool cycle_is_told = false;    ///< `exposure_to_set_s` follows from what was seen; else from the usual cycles
    FrameTiming timing;
};

/// From runs of frames of black, white and, if shown, red, green and blue.
///
/// The variation is the covariance over time of two halves of the tiles (a chess pattern): their noise has nothing in
/// common, the light has. Refused: nothing of the projector seen, saturated, fewer than 24 frames in a row.
CycleResult measure_cycle(const LightRecording& recording, const CycleSettings& settings = {});

}  // namespace planlight
