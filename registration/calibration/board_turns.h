#pragma once

#include <vector>

#include "planning_io/types/rigid_transform.h"
#include "registration/calibration/board_spec.h"
#include "registration/calibration/find_board.h"

namespace planlight {

/// A turn of a chessboard in its plane that puts corners on corners: corner i comes to where corner `names[i]` was.
struct BoardTurn {
    std::vector<int> names;
    RigidTransform to_from = RigidTransform::Identity();  ///< of a point of the board, in board
};

/// None, by half, and of a square board by a quarter either way (its corners lie the same; its colours may not).
std::vector<BoardTurn> turns_of(const BoardSpec& board);

/// The corners under the names of the turn, in ascending order.
void rename(BoardCorners& corners, const BoardTurn& turn);

}  // namespace planlight
