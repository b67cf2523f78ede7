#pragma once

#include <string>

#include "planning_io/types/image.h"
#include "registration/calibration/board_spec.h"

namespace planlight {

/// How dark squares are printed: grey, so that projected light still shows on them (60 % ink).
constexpr int kBoardDark = 102;

/// A square's side in modules: markers are 6 modules wide (4x4 bits and their border), in the middle of a square.
constexpr int kModulesPerSquare = 8;

/// The squares and markers at one pixel a module: 0 dark, 255 white. Markers: OpenCV's dictionary 4X4_100, in order.
GrayImage board_modules(const BoardSpec& board);

/// The board without margin, `px_per_square` pixels a square (rounded module edges; exact where it is a multiple of 8).
GrayImage draw_board(const BoardSpec& board, int px_per_square, int dark = kBoardDark);

/// The sheet to print as PNG: board, white margin of a square, the board's text under it; 10 pixels a mm, said in the
/// file.
std::string board_png(const BoardSpec& board);

/// The sheet to print as PDF, one page, vector, true mm: A4 or A3 where it fits, else a page of its own size.
std::string board_pdf(const BoardSpec& board);

}  // namespace planlight
