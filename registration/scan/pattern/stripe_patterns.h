#pragma once

#include <string>
#include <vector>

#include "planning_io/types/image.h"

namespace planlight {

/// The coded light of a scan: Gray code for the order, phase shift for the sub-pixel (research: Gray code unwrapping
/// has better noise immunity than two frequencies; 8 steps reject the harmonics of an uncalibrated gamma).
struct StripeSettings {
    int width = 0, height = 0;    ///< of the projector, pixels
    int phase_steps = 8;          ///< shifts per direction, >= 3
    double phase_period_px = 16;  ///< projector pixels per fringe
    bool rows = true;             ///< both directions; false: columns only
    bool inverse = true;          ///< each Gray picture also inverted, so that a bit is decided against its opposite
    int brightness = 255;         ///< of white
    /// Periods of further fringes, projector pixels: their beats with the first tell its fringes apart (heterodyne),
    /// and there is no Gray code. Empty: Gray code.
    std::vector<double> order_periods_px;
    int order_steps = 5;  ///< shifts of each further fringe
    /// The code's number at the first column and row of the projector: of captures of others whose Gray code, without
    /// fringes, is centred in a larger power of two. What is drawn here begins at 0.
    int begins_at_column = 0, begins_at_row = 0;
};

/// A third of the pictures and of the time: columns only, each bit without its inverse, five shifts (they cancel the
/// harmonics of a gamma up to the third). 14 pictures for 800 columns, 15 for 1920. Places along the other direction
/// follow from the two cameras' epipolar lines, so that points need both cameras, and the projector is not resected.
StripeSettings fast_stripes(int width, int height);

/// Fringes of several frequencies instead of a Gray code: three for 800 columns, four for 1920, with periods of 16 to
/// 32 pixels that keep the phases of all places as far apart as they can. 38 pictures for 800 x 600 (20 with columns
/// only), 48 (25) for 1920 x 1080. At least 128 pixels; takes a second for 10,000.
StripeSettings multi_frequency_stripes(int width, int height, bool rows = true);

/// What a picture of the sequence is.
struct StripePattern {
    enum class Kind { white, black, gray_bit, gray_bit_inverse, phase } kind;
    bool along_rows = false;  ///< true: codes the projector row (horizontal stripes); false: the column
    int index = 0;            ///< bit (0 = coarsest) or phase step
    std::string name;         ///< e.g. "column-gray-3", "row-phase-0"; also the file name in a capture folder
    int frequency =
        0;  ///< of a fringe: 0 the first, else of `order_periods_px` ("column-phase2-0" is the first of them)
};

/// The Gray pictures of one direction, coarsest bit first, each followed by its inverse where `inverse`: "row-gray-0",
/// "row-gray-0-inverse" and so on.
std::vector<StripePattern> gray_patterns(int bits, bool along_rows, bool inverse);

/// The sequence in the order it is projected: white, black, then per direction Gray bits (with inverses) and phases, or
/// the phases of all frequencies.
std::vector<StripePattern> stripe_sequence(const StripeSettings& settings);

/// Period (projector pixels) and shifts of a fringe.
double period_of(const StripeSettings& settings, int frequency);

/// Phase steps of one of the frequencies, by its place in the settings.
int steps_of(const StripeSettings& settings, int frequency);

/// Bits of the Gray code of one direction; 0 where fringes of further frequencies take its place. It counts half
/// periods of the fringe, not periods: a code wrong by one half period at its own border still unwraps the phase to the
/// right period.
int gray_bits(const StripeSettings& settings, bool along_rows);

/// Throws std::invalid_argument, naming the setting, when no code can be made of the settings.
void check_stripes(const StripeSettings& settings);

/// One picture of the sequence as the projector shows it. Throws std::invalid_argument on settings that make no code.
RgbImage draw_stripes(const StripeSettings& settings, const StripePattern& pattern);

}  // namespace planlight
