#include "registration/calibration/board_spec.h"

#include <fmt/format.h>

#include <algorithm>
#include <regex>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

constexpr int kMostSquares = 200;  ///< as many as there are markers for (100)
constexpr double kMost_mm = 5000;  ///< a PDF page ends at 5080 mm

[[noreturn]] void refuse(const std::string& text, const std::string& why) {
    throw InputError(
        {}, fmt::format("the board \"{}\" {}", text, why),
        "Give a board as in \"charuco 10x7 25 mm\" (squares) or \"chessboard 9x6 25 mm\" (inner corners).");
}

}  // namespace

Eigen::Vector3d BoardSpec::corner_in_board(int id) const {
    return {(id % corners_across() + 1) * square_mm, (id / corners_across() + 1) * square_mm * stretch, 0};
}

BoardSpec parse_board(const std::string& text) {
    static const std::regex kForm(
        R"(\s*([a-z]+)\s+(\d{1,3})\s*x\s*(\d{1,3})(?:\s+(?:squares|corners))?\s+(\d+(?:\.\d+)?)\s*([a-z]*)\s*)",
        std::regex::icase);
    std::smatch found;
    if (text.size() > 200 || !std::regex_match(text, found, kForm)) refuse(text.substr(0, 200), "is not understood");
    BoardSpec board;
    std::string kind = found[1], unit = found[5];
    for (std::string* word : {&kind, &unit})
        for (char& c : *word) c = static_cast<char>(std::tolower(c));
    if (kind == "charuco")
        board.kind = BoardSpec::Kind::charuco;
    else if (kind == "chessboard")
        board.kind = BoardSpec::Kind::chessboard;
    else
        refuse(text, "is neither a charuco nor a chessboard");
    if (unit != "mm") refuse(text, "does not say its squares in mm");
    board.columns = std::stoi(found[2]);
    board.rows = std::stoi(found[3]);
    board.square_mm = std::stod(found[4]);
    if (board.corners_across() < 3 || board.corners_down() < 3)
        refuse(text, "is too small: it needs 3 inner corners each way");
    if (board.kind == BoardSpec::Kind::charuco && board.columns * board.rows > kMostSquares)
        refuse(text, fmt::format("has more than {} squares", kMostSquares));
    if (!(board.square_mm >= 1 && board.square_mm <= 1000)) refuse(text, "has squares under 1 mm or over 1 m");
    if (const double most_mm = std::max(board.width_mm(), board.height_mm()); most_mm > kMost_mm)
        refuse(text,
               fmt::format("is {:.1f} m long; {:g} m is the most that a page can be", most_mm / 1000, kMost_mm / 1000));
    return board;
}

std::string text_of(const BoardSpec& board) {
    return fmt::format("{} {}x{} {:.6g} mm", board.kind == BoardSpec::Kind::charuco ? "charuco" : "chessboard",
                       board.columns, board.rows, board.square_mm);
}

}  // namespace planlight
