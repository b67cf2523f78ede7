#pragma once

#include "registration/calibration/find_board.h"

namespace planlight {

/// Looks the corners up again by fitting two blurred edges, free to turn, to the picture along the sides of the four
/// squares (0.4 squares, at most 24 pixels, either way; no farther off the edges than the ring of white round a
/// marker), under light that may fall off. Where the board is foreshortened the place looked at is foreshortened with
/// it, so that no marker gets in. A corner whose fit does not settle within a quarter square stays where it was.
/// Levenberg-Marquardt.
void refine_corners(const GrayImage& picture, const BoardSpec& board, BoardCorners& corners);

}  // namespace planlight
