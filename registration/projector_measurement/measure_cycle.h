#pragma once

#include <optional>
#include <string>
#include <vector>

#include "registration/projector_measurement/light_recording.h"

namespace planlight {

/// Of the search for the projector's refresh in a camera's pictures.
struct CycleSettings {
    double refresh_hz = 60;             ///< of the projector; cycles of colour wheels are small multiples of it
    double refresh_tolerance_hz = 0.1;  ///< how well that is known; 0.1 covers 59.94 that is called 60
    double noticed = 0.005;             ///< share of the light (standard deviation); less is called steady
};

/// How one steady picture varied from frame to frame, beyond noise.
struct CycleRun {
    std::string name;  ///< black, white, red, green, blue
    std::size_t frames = 0;
    double light_grey = 0;  ///< brighter than black, mean over tiles and whole cycles; for black: its own brightness
    /// Standard deviation of the light of an exposure that begins at any moment of the cycle, share of `light_grey`.
    /// Noise and slow drift are taken out, and but for black what the room's lamps vary.
    double variation = 0;
    double variation_sigma = 0;  ///< one standard deviation of `variation`
    double at_most = 0;          ///< 95 % bound of `variation`, also when nothing was noticed
    bool varies = false;         ///< beyond noise, and more than `CycleSettings::noticed`
    /// False: the light beats too slowly against the frames, and they met only a part of its cycle. `variation` is
    /// then that of what they met, and `at_most` what an exposure of that length can vary at all.
    bool size_is_told = true;
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
    std::vector<double> unseen_hz;  ///< usual cycles that may stand still before these frames: multiples of their rate
    bool lamps_may_hide = false, wheel_may_hide = false;  ///< some of `unseen_hz` are theirs
    bool room_varies = false, projector_varies = false;
    double worst = 0;              ///< largest variation of the projector over the colours, share of light
    bool worst_is_told = true;     ///< false: of one of the colours only a part of its cycle was met
    double exposure_to_set_s = 0;  ///< the shortest, not under the present one, of whole cycles; 0: nothing to cure
    bool cycle_is_told = false;    ///< `exposure_to_set_s` follows from what was seen; else from the usual cycles
    FrameTiming timing;
};

/// From frames of black, white and, if shown, red, green and blue.
///
/// Every frame is an average over its exposure, and what is told is the variation of these averages. It is seen by the
/// phases of the cycle that the frames happen to meet: many short visits to each colour, at irregular moments over a
/// minute, meet more of them than one run (`record_cycle`). Mean, drift and harmonics of the one frequency that
/// explains most are fitted to two halves of the tiles (a chess pattern), whose noise has nothing in common.
/// Refused: nothing of the projector seen, saturated, fewer than 24 frames of black and of another colour.
CycleResult measure_cycle(const LightRecording& recording, const CycleSettings& settings = {});

}  // namespace planlight
