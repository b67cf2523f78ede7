#include "registration/calibration/board_turns.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>
#include <tuple>
#include <utility>

namespace planlight {

using Eigen::Vector2d;
using Eigen::Vector3d;

std::vector<BoardTurn> turns_of(const BoardSpec& board) {
    const int across = board.corners_across(), down = board.corners_down();
    std::vector<BoardTurn> turns;
    for (int quarters = 0; quarters < 4; quarters += across == down ? 1 : 2) {
        BoardTurn turn;
        for (int id = 0; id < board.corner_count(); ++id) {
            int x = id % across, y = id / across;
            if (quarters == 2) x = across - 1 - x, y = down - 1 - y;
            if (quarters == 1) x = across - 1 - std::exchange(y, x);
            if (quarters == 3) y = down - 1 - std::exchange(x, y);
            turn.names.push_back(y * across + x);
        }
        const Vector3d middle(board.width_mm() / 2, board.height_mm() / 2, 0);
        turn.to_from.linear() =
            Eigen::AngleAxisd(quarters * std::numbers::pi / 2, Vector3d::UnitZ()).toRotationMatrix();
        turn.to_from.translation() = middle - turn.to_from.linear() * middle;
        turns.push_back(std::move(turn));
    }
    return turns;
}

void rename(BoardCorners& corners, const BoardTurn& turn) {
    std::vector<std::pair<int, Vector2d>> named;
    for (std::size_t i = 0; i < corners.size(); ++i)
        named.emplace_back(turn.names[static_cast<std::size_t>(corners.ids[i])], corners.pixels[i]);
    std::sort(named.begin(), named.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (std::size_t i = 0; i < named.size(); ++i) std::tie(corners.ids[i], corners.pixels[i]) = named[i];
}

}  // namespace planlight
