#pragma once

#include <Eigen/Core>
#include <vector>

#include "planning_io/types/image.h"
#include "registration/calibration/board_spec.h"

namespace planlight {

/// Inner corners of a board in one picture.
struct BoardCorners {
    std::vector<int> ids;                 ///< as `BoardSpec::corner_in_board`; ascending
    std::vector<Eigen::Vector2d> pixels;  ///< sub-pixel, (0,0) = centre of the first pixel
    std::size_t size() const { return ids.size(); }
};

/// The board's corners; empty where it is not seen. A ChArUco board may be seen in part, a chessboard only whole. A
/// chessboard without a top (`BoardSpec::has_a_top`) is named so that its first corner is the one nearer to the
/// picture's top left.
BoardCorners find_board(const GrayImage& picture, const BoardSpec& board);

/// Six corners or more, not all in one row or column of the board: enough to place it.
bool spans_a_plane(const BoardCorners& corners, const BoardSpec& board);

/// The same corners looked up again in a picture in which the board lies all but the same.
BoardCorners follow_board(const GrayImage& picture, const BoardCorners& corners, const BoardSpec& board);

}  // namespace planlight
