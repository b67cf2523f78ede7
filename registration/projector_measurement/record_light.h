#pragma once

#include <functional>

#include "registration/devices/projector.h"
#include "registration/devices/stereo_camera.h"
#include "registration/projector_measurement/light_recording.h"

namespace planlight {

/// The devices of a measurement, and the session's time.
struct LightBench {
    Projector& projector;
    StereoCamera& cameras;
    const Clock& clock;
    std::function<void(Instant)> wait_until;       ///< returns at that moment of `clock`; a past moment: at once
    std::function<void(double)> progress;          ///< share done, 0 to 1; may be empty
    std::function<void(const StereoFrame&)> keep;  ///< every frame as it was taken, to be written; may be empty
};

/// What light is ordered, how often and how long.
struct RecordSettings {
    Instant settle = std::chrono::milliseconds(250);  ///< longer than any delay of a projector and its dynamic contrast
    std::chrono::milliseconds patience{2000};         ///< for one frame
    int grey_passes = 2, frames_a_grey = 2;           ///< response
    int cycle_visits = 28, frames_a_visit = 3;        ///< colour cycle, to each colour
    int frames_a_flash = 3;                           ///< latency: a bit of the code
    int code_bits = 63;                               ///< latency: of the code, from its beginning
    int code_passes = 2;                              ///< latency; 1: at random moments only, in half the time
    unsigned seed = 1;                                ///< of the order of greys, and of the flashes
};

/// The greys of the response, ends denser than the middle (0 to 255, rising).
std::vector<int> response_greys();

/// Every grey in random order, white and black again and again between them, and each colour by itself.
/// All three recorders show full pictures of one colour, leave the projector dark, and throw what the devices throw.
LightRecording record_response(const LightBench& bench, const RecordSettings& settings = {});

/// With the lid before the lens: what the room alone gives. The recording's order says `covered`.
void record_covered(const LightBench& bench, LightRecording& recording, const RecordSettings& settings = {});

/// Black, white, red, green and blue, again and again in random order, each `cycle_visits` times for `frames_a_visit`
/// frames, with irregular pauses: a minute in which the frames meet the cycle at many phases, also where it beats
/// slowly against them.
LightRecording record_cycle(const LightBench& bench, const RecordSettings& settings = {});

/// Black and white at rest, then a pseudo-random code of 63 bits, each a few frames long and begun at a random moment
/// between two frames; then the code once more with its changes aimed at the middle of an exposure, where they are seen
/// to a fraction of it.
LightRecording record_latency(const LightBench& bench, const RecordSettings& settings = {});

/// The code: 63 bits of a shift register (x^6 + x^5 + 1), in which no window of six bits comes twice.
std::vector<bool> flash_code();

}  // namespace planlight
