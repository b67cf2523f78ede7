#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace planlight {

/// A flat calibration board. Frame `board`, mm: origin at the outer corner of the first (top left) square, x right, y
/// down along the sheet, z into the sheet, away from who looks at it.
struct BoardSpec {
    enum class Kind { charuco, chessboard } kind = Kind::charuco;
    int columns = 10, rows = 7;  ///< squares of a ChArUco board; inner corners of a chessboard (each as OpenCV counts)
    double square_mm = 25;
    double stretch = 1;  ///< height of a square over its width; 1 of every board that was printed as it should be

    int squares_across() const { return kind == Kind::charuco ? columns : columns + 1; }
    int squares_down() const { return kind == Kind::charuco ? rows : rows + 1; }
    int corners_across() const { return squares_across() - 1; }
    int corners_down() const { return squares_down() - 1; }
    int corner_count() const { return corners_across() * corners_down(); }
    double width_mm() const { return squares_across() * square_mm; }
    double height_mm() const { return squares_down() * square_mm * stretch; }

    /// Inner corner `id` (rows from the top, 0 = first) on the flat board, z = 0.
    Eigen::Vector3d corner_in_board(int id) const;

    /// False for a chessboard that looks the same when turned by half a turn: two cameras may then name its corners
    /// differently.
    bool has_a_top() const { return kind == Kind::charuco || (squares_across() + squares_down()) % 2 == 1; }
};

/// "charuco 10x7 25 mm" (squares) or "chessboard 9x6 24.96 mm" (inner corners). Throws InputError saying what is wrong.
BoardSpec parse_board(const std::string& text);

/// The text that `parse_board` reads.
std::string text_of(const BoardSpec& board);

}  // namespace planlight
