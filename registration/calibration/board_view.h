#pragma once

#include "planning_io/types/image.h"
#include "registration/calibration/find_board.h"

namespace planlight {

/// What one live picture shows of the board, and how well.
struct BoardView {
    int width = 0, height = 0;   ///< of the picture
    BoardCorners corners;        ///< empty: not seen
    double paper_grey = 0;       ///< median of the brighter side of the squares' edges
    double contrast_grey = 0;    ///< median of paper less ink across those edges
    double saturated_share = 0;  ///< of the edges, whose paper is saturated
    double blur_px = 0;          ///< sigma of an edge's blur, median; 0: not known
};

/// Finds the board and measures it along the edges between neighbouring corners.
BoardView look_at_board(const GrayImage& picture, const BoardSpec& board);

}  // namespace planlight
