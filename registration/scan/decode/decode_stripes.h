#pragma once

#include <cstddef>
#include <span>

#include "planning_io/types/image.h"
#include "planning_io/types/large_array.h"
#include "registration/scan/pattern/stripe_patterns.h"

namespace planlight {

/// From when on a pixel is too dark, too bright or too noisy to be read.
struct DecodeSettings {
    double min_modulation = 4;  ///< grey values: fringe amplitude below which a pixel is dark
    int saturated_at = 254;     ///< grey value
    double max_phase_sigma_px = 0.6;
    double min_direct_fraction = 0.08;  ///< fringe amplitude by (white - black): below it the light came by detours
    double noise_grey = 0;              ///< one standard deviation of a grey value; 0: measured in the frames
};

/// Per camera pixel the projector pixel that lit it; NaN where it is not known. An uncertain pixel is dropped, never
/// guessed.
struct DecodedView {
    int width = 0, height = 0;      ///< of the camera
    LargeArray<float> column, row;  ///< projector pixels (sub-pixel); `row` empty when only columns were coded
    LargeArray<float> sigma_px;     ///< one standard deviation of `column`, projector pixels
    LargeArray<float> dimness;  ///< inverse of the projector's light, in any unit; empty: sigma_px, which goes with it
    double noise_grey = 0;      ///< one standard deviation of a grey value, as measured or given
    std::size_t decoded = 0, dark = 0, saturated = 0, uncertain = 0;  ///< pixels, by what became of them
};

/// `dimness` of a view as it is used: sigma_px where it has none of its own.
inline const LargeArray<float>& dimness_of(const DecodedView& view) {
    return view.dimness.empty() ? view.sigma_px : view.dimness;
}

/// Decodes one camera's frames, in the order of `stripe_sequence(settings)`. Throws std::invalid_argument when their
/// number or sizes do not fit.
DecodedView decode_stripes(std::span<const GrayImage> frames, const StripeSettings& stripes,
                           const DecodeSettings& settings = {});

}  // namespace planlight
