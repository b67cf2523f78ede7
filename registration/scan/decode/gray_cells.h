#pragma once

#include <vector>

#include "planning_io/types/image.h"
#include "registration/scan/decode/decode_stripes.h"

namespace planlight {

/// One direction of a Gray code as it was captured, coarsest bit first.
struct GrayDirection {
    int size = 0;        ///< of the projector along it, pixels
    double cell_px = 1;  ///< of the finest bit that was captured, projector pixels
    int begins_at = 0;   ///< the code's number at the first pixel
    std::vector<const GrayImage*> bits,
        inverses;  ///< equally many; inverses empty: a bit is decided by the mean of white and black
};

/// A Gray code without fringes: someone else's sequence, or what is left of ours where the fringes or the finest bits
/// are missing. `rows.bits` empty: only columns were coded.
struct GrayFrames {
    const GrayImage* white = nullptr;
    const GrayImage* black = nullptr;
    GrayDirection columns, rows;
};

/// From when on a bit is in doubt, and a bit of the whole picture is of no use.
struct GrayCellSettings {
    double least_difference_grey = 5,
           least_share = 0.15;   ///< of (white - black): a bit that differs by less is in doubt
    double useless_share = 0.5;  ///< of the lit pixels in doubt: the optics do not resolve the bit
    int saturated_at = 254;
};

/// The projector pixels of the cells, smoothed over about three cells of the picture, so that a surface is not stairs:
/// a plane is fitted to the codes round a pixel, and a pixel off it by more than a cell and a half is dropped.
struct GrayCells {
    DecodedView view;  ///< `sigma_px` is that of the smoothed column
    double step_px =
        0;  ///< size of the finest cell that could be read, the larger of both directions, projector pixels
    int useless_bits = 0;  ///< captured and too fine for the optics
};

/// Finest bits that most lit pixels cannot decide are left out: the cells are larger then, and not wrong. Throws
/// std::invalid_argument when sizes or numbers do not fit, or no bit is there.
GrayCells decode_gray_cells(const GrayFrames& frames, const GrayCellSettings& settings = {});

}  // namespace planlight
