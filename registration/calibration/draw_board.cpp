#include "registration/calibration/draw_board.h"

#include <fmt/format.h>
#include <zlib.h>

#include <cmath>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace planlight {
namespace {

std::string big_endian(std::uint32_t v) {
    return {static_cast<char>(v >> 24), static_cast<char>(v >> 16), static_cast<char>(v >> 8), static_cast<char>(v)};
}

/// A PNG chunk (PNG specification, 5.3).
std::string chunk(const std::string& type_and_data) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(type_and_data.data());
    const auto crc = static_cast<std::uint32_t>(crc32(0, bytes, static_cast<uInt>(type_and_data.size())));
    return big_endian(static_cast<std::uint32_t>(type_and_data.size() - 4)) + type_and_data + big_endian(crc);
}

/// Whole pixels a module, about 10 a mm (fewer on a board that would fill the memory). The file says how many there are
/// in a metre, so that the print has the square's true size.
int png_px_per_square(const BoardSpec& board) {
    constexpr double kPxPerMm = 10, kMostPx = 12000;
    const double px_per_mm = std::min(kPxPerMm, kMostPx / std::max(board.width_mm(), board.height_mm()));
    return kModulesPerSquare *
           std::max(1, static_cast<int>(std::lround(board.square_mm * px_per_mm / kModulesPerSquare)));
}

}  // namespace

GrayImage board_modules(const BoardSpec& board) {
    const int w = board.squares_across(), h = board.squares_down();
    GrayImage modules(w * kModulesPerSquare, h * kModulesPerSquare, 255);
    if (board.kind == BoardSpec::Kind::chessboard) {
        for (int y = 0; y < modules.height; ++y)
            for (int x = 0; x < modules.width; ++x)
                if ((x / kModulesPerSquare + y / kModulesPerSquare) % 2 == 0) modules.at(x, y) = 0;
        return modules;
    }
    const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_100);
    const auto charuco = cv::aruco::CharucoBoard::create(w, h, 8, 6, dictionary);
    cv::Mat drawn;
    charuco->draw({w * kModulesPerSquare * 4, h * kModulesPerSquare * 4}, drawn, 0,
                  1);  // 4 pixels a module, its middle is read
    for (int y = 0; y < modules.height; ++y)
        for (int x = 0; x < modules.width; ++x) modules.at(x, y) = drawn.at<std::uint8_t>(4 * y + 2, 4 * x + 2);
    return modules;
}

GrayImage draw_board(const BoardSpec& board, int px_per_square, int dark) {
    const GrayImage modules = board_modules(board);
    GrayImage picture(board.squares_across() * px_per_square, board.squares_down() * px_per_square);
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x)
            picture.at(x, y) = modules.at(x * kModulesPerSquare / px_per_square, y * kModulesPerSquare / px_per_square)
                                   ? std::uint8_t{255}
                                   : static_cast<std::uint8_t>(dark);
    return picture;
}

std::string board_png(const BoardSpec& board) {
    const int square = png_px_per_square(board), margin = std::max(square, 100);
    GrayImage drawn = draw_board(board, square);
    cv::Mat sheet(drawn.height + 2 * margin, drawn.width + 2 * margin, CV_8UC1, cv::Scalar(255));
    cv::Mat(drawn.height, drawn.width, CV_8UC1, drawn.pixels.data())
        .copyTo(sheet(cv::Rect(margin, margin, drawn.width, drawn.height)));
    const std::string text = fmt::format("Planlight board: {}. Print at 100 %, then measure: {} squares = {:.1f} mm.",
                                         text_of(board), board.squares_across(), board.width_mm());
    int base = 0;
    const double wide = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, 1, 2, &base).width;
    const double scale = std::min(1.6, 0.9 * drawn.width / wide);
    cv::putText(sheet, text, {margin, sheet.rows - margin / 3}, cv::FONT_HERSHEY_SIMPLEX, scale, cv::Scalar(60), 2,
                cv::LINE_AA);
    std::vector<unsigned char> bytes;
    cv::imencode(".png", sheet, bytes, {cv::IMWRITE_PNG_COMPRESSION, 6});
    std::string file(bytes.begin(), bytes.end());
    constexpr std::size_t kAfterHeader = 8 + 25;  // signature and IHDR
    const std::string per_metre = big_endian(static_cast<std::uint32_t>(std::lround(1000 * square / board.square_mm)));
    return file.insert(kAfterHeader, chunk("pHYs" + per_metre + per_metre + '\1'));
}

}  // namespace planlight
