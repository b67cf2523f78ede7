#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "planning_io/types/error.h"
#include "registration/calibration/board_spec.h"
#include "registration/calibration/draw_board.h"
#include "registration/calibration/find_board.h"

namespace planlight {
namespace {

TEST(BoardSpec, ReadsWhatItWrites) {
    for (const char* text : {"charuco 10x7 25 mm", "chessboard 9x6 24.96 mm"})
        EXPECT_EQ(text_of(parse_board(text)), text);
    const BoardSpec chess = parse_board("Chessboard 9 x 6 corners 25mm");
    EXPECT_EQ(chess.corner_count(), 54);
    EXPECT_EQ(chess.squares_across(), 10);
    EXPECT_EQ(parse_board("charuco 10x7 squares 25 mm").corner_count(), 54);
    EXPECT_EQ(text_of(parse_board("CHARUCO 10X7 25 MM")), "charuco 10x7 25 mm");
}

TEST(BoardSpec, RefusesWhatItCannotMean) {
    for (const char* text : {"", "charuco", "charuco 10x7", "charuco 10x7 25", "charuco 10x7 25 cm",
                             "circles 10x7 25 mm", "charuco 2x7 25 mm", "charuco 99x99 25 mm", "chessboard 9x6 0 mm",
                             "charuco -10x7 25 mm", "charuco 10x7 nan mm", "chessboard 999x999 1000 mm"})
        EXPECT_THROW(parse_board(text), InputError) << text;
}

/// A big-endian number of a PNG file.
std::uint32_t number_at(const std::string& png, std::size_t at) {
    std::uint32_t n = 0;
    for (std::size_t i = 0; i < 4; ++i) n = n << 8 | static_cast<std::uint8_t>(png.at(at + i));
    return n;
}

// A square of 24.96 mm is not a whole number of tenths: pixels and their number in a metre agree all the same.
TEST(BoardPng, IsPrintedInItsTrueSizeToAHundredthOfAPercent) {
    for (const char* text :
         {"chessboard 9x6 24.96 mm", "charuco 10x7 1.05 mm", "charuco 10x7 25 mm", "chessboard 90x60 40 mm"}) {
        const BoardSpec board = parse_board(text);
        const std::string png = board_png(board);
        const std::size_t phys = png.find("pHYs");
        ASSERT_NE(phys, std::string::npos);
        EXPECT_EQ(png.at(phys + 12), 1) << "pixels a metre";
        const double px_per_mm = number_at(png, phys + 4) / 1000.0;
        EXPECT_LT(number_at(png, 16), 15000u) << text << " fits the memory";
        const std::vector<std::uint8_t> bytes(png.begin(), png.end());
        const cv::Mat sheet = cv::imdecode(bytes, cv::IMREAD_GRAYSCALE);
        // Down the left column of squares: dark from the top of the first to the bottom of the last dark one.
        const int x = (sheet.cols - static_cast<int>(std::lround(board.width_mm() * px_per_mm))) / 2 + 1;
        int first = sheet.rows, last = 0;
        for (int y = 0; y < sheet.rows; ++y) {
            if (sheet.at<std::uint8_t>(y, x) != kBoardDark) continue;
            first = std::min(first, y);
            last = std::max(last, y + 1);
        }
        const int squares = board.squares_down() - (board.squares_down() % 2 == 0 ? 1 : 0);
        EXPECT_NEAR((last - first) / px_per_mm, squares * board.square_mm, 1e-4 * squares * board.square_mm) << text;
    }
}

/// The picture with a white margin and blur, as a camera that looks straight at the board; the margin in pixels.
GrayImage photographed(const BoardSpec& board, int px_per_square, int margin) {
    GrayImage drawn = draw_board(board, px_per_square);
    GrayImage picture(drawn.width + 2 * margin, drawn.height + 2 * margin, 220);
    for (int y = 0; y < drawn.height; ++y)
        for (int x = 0; x < drawn.width; ++x)
            picture.at(x + margin, y + margin) = static_cast<std::uint8_t>(drawn.at(x, y) * 220 / 255);
    cv::Mat view(picture.height, picture.width, CV_8UC1, picture.pixels.data());
    cv::GaussianBlur(view, view, {0, 0}, 0.7);
    return picture;
}

// The corners that are found are those that were drawn, under their own names: frames, order and half pixels agree.
TEST(FindBoard, FindsEveryDrawnCornerWhereItWasDrawn) {
    for (const char* text :
         {"charuco 10x7 25 mm", "charuco 9x6 25 mm", "chessboard 9x6 25 mm", "chessboard 9x7 25 mm"}) {
        const BoardSpec board = parse_board(text);
        const int px = 40, margin = 60;
        const BoardCorners found = find_board(photographed(board, px, margin), board);
        ASSERT_EQ(found.size(), static_cast<std::size_t>(board.corner_count())) << text;
        for (std::size_t i = 0; i < found.size(); ++i) {
            const Eigen::Vector2d drawn = board.corner_in_board(found.ids[i]).head<2>() * px / board.square_mm +
                                          Eigen::Vector2d::Constant(margin - 0.5);
            EXPECT_LT((found.pixels[i] - drawn).norm(), 0.03) << text << " corner " << found.ids[i];
        }
    }
}

/// A board seen by a pinhole camera, tilted and turned in its plane; `pixel_of_drawn` from pixels of the drawing.
GrayImage tilted_board(const GrayImage& drawn, double tilt_deg, double turn_deg, Eigen::Matrix3d& pixel_of_drawn) {
    constexpr int kWidth = 744, kHeight = 576, kFiner = 6;
    const double focal = 2200, distance = focal / 420 * drawn.width;  // 420 pixels across when seen straight on
    const Eigen::Matrix3d turn = (Eigen::AngleAxisd(tilt_deg * M_PI / 180, Eigen::Vector3d::UnitX()) *
                                  Eigen::AngleAxisd(turn_deg * M_PI / 180, Eigen::Vector3d::UnitZ()))
                                     .toRotationMatrix();
    Eigen::Matrix3d camera, placed;
    camera << focal, 0, 0.5 * kWidth, 0, focal, 0.5 * kHeight, 0, 0, 1;
    placed << turn.col(0), turn.col(1),
        Eigen::Vector3d(0, 0, distance) - turn * Eigen::Vector3d(0.5 * drawn.width, 0.5 * drawn.height, 0);
    pixel_of_drawn = camera * placed;
    Eigen::Matrix3d finer;
    finer << kFiner, 0, 0.5 * (kFiner - 1), 0, kFiner, 0.5 * (kFiner - 1), 0, 0, 1;
    const Eigen::Matrix3d to_finer = finer * pixel_of_drawn;
    cv::Matx33d warp;
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) warp(r, c) = to_finer(r, c);
    const cv::Mat sheet(drawn.height, drawn.width, CV_8UC1, const_cast<std::uint8_t*>(drawn.pixels.data()));
    cv::Mat large, seen;
    cv::warpPerspective(sheet, large, warp, {kFiner * kWidth, kFiner * kHeight}, cv::INTER_LINEAR, cv::BORDER_CONSTANT,
                        {255});
    cv::resize(large, seen, {kWidth, kHeight}, 0, 0, cv::INTER_AREA);
    cv::GaussianBlur(seen, seen, {0, 0}, 0.9);
    GrayImage picture(kWidth, kHeight);
    std::transform(seen.begin<std::uint8_t>(), seen.end<std::uint8_t>(), picture.pixels.begin(),
                   [](std::uint8_t v) { return static_cast<std::uint8_t>(20 + v * 3 / 5); });
    return picture;
}

// Where a board is foreshortened its markers come near to the corners. A window of fixed size that reaches into them is
// off by up to a pixel; a flat-on board is found as well as a tilted one.
TEST(FindBoard, CornersOfATiltedBoardAreFoundToAThirtiethOfAPixel) {
    const BoardSpec board = parse_board("charuco 10x7 25 mm");
    constexpr int kDrawnPx = 64;
    const GrayImage drawn = draw_board(board, kDrawnPx);
    for (const double tilt_deg : {0.0, 35.0, 55.0})
        for (const double turn_deg : {7.0, 61.0}) {
            Eigen::Matrix3d pixel_of_drawn;
            const BoardCorners found = find_board(tilted_board(drawn, tilt_deg, turn_deg, pixel_of_drawn), board);
            EXPECT_GE(found.size(), 50u) << tilt_deg << " " << turn_deg;
            for (std::size_t i = 0; i < found.size(); ++i) {
                const Eigen::Vector2d at = board.corner_in_board(found.ids[i]).head<2>() * kDrawnPx / board.square_mm -
                                           Eigen::Vector2d::Constant(0.5);
                const Eigen::Vector2d wanted = (pixel_of_drawn * at.homogeneous()).hnormalized();
                EXPECT_LT((found.pixels[i] - wanted).norm(), 0.03)
                    << "tilt " << tilt_deg << " turn " << turn_deg << " corner " << found.ids[i];
            }
        }
}

// A chessboard with a top keeps its names when the camera is upside down.
TEST(FindBoard, AChessboardUpsideDownKeepsItsNames) {
    const BoardSpec board = parse_board("chessboard 9x6 25 mm");
    GrayImage picture = photographed(board, 40, 60);
    std::reverse(picture.pixels.begin(), picture.pixels.end());
    const BoardCorners found = find_board(picture, board);
    ASSERT_EQ(found.size(), 54u);
    const Eigen::Vector2d first = found.pixels.front();
    EXPECT_NEAR(first.x(), picture.width - 1 - (60 + 40 - 0.5), 0.05);
    EXPECT_NEAR(first.y(), picture.height - 1 - (60 + 40 - 0.5), 0.05);
}

TEST(FindBoard, AnotherBoardOrNoneIsNotFound) {
    const BoardSpec board = parse_board("charuco 10x7 25 mm");
    EXPECT_EQ(find_board(GrayImage(640, 480, 128), board).size(), 0u);
    EXPECT_EQ(find_board(photographed(parse_board("chessboard 9x6 25 mm"), 40, 60), board).size(), 0u);
    EXPECT_EQ(find_board(photographed(parse_board("chessboard 7x5 25 mm"), 40, 60), parse_board("chessboard 9x6 25 mm"))
                  .size(),
              0u);
}

TEST(FindBoard, PicturesOfAFewPixelsAreNoBoard) {
    for (const char* text : {"charuco 10x7 25 mm", "chessboard 9x6 25 mm"})
        for (const auto& [w, h] : {std::pair{1, 1}, std::pair{3, 200}, std::pair{12, 9}})
            EXPECT_EQ(find_board(GrayImage(w, h, 90), parse_board(text)).size(), 0u);
}

/// A row of corners alone leaves the board free to swing about it.
TEST(FindBoard, ARowOfCornersDoesNotPlaceABoard) {
    const BoardSpec board = parse_board("charuco 10x7 25 mm");
    BoardCorners corners;
    for (int id = 0; id < 9; ++id) corners.ids.push_back(id), corners.pixels.emplace_back(40 * id, 100);
    EXPECT_FALSE(spans_a_plane(corners, board));
    corners.ids.push_back(9), corners.pixels.emplace_back(0, 140);
    EXPECT_TRUE(spans_a_plane(corners, board));
}

// What is printed measures what it says: by the PNG's own density, and by the PDF's rectangles.
TEST(DrawBoard, TheSheetIsTrueToTheMillimetre) {
    const BoardSpec board = parse_board("chessboard 9x6 25 mm");
    const std::string png = board_png(board);
    const auto density = png.find("pHYs");
    ASSERT_NE(density, std::string::npos);
    double px_per_m = 0;
    for (std::size_t i = 0; i < 4; ++i) px_per_m = 256 * px_per_m + static_cast<std::uint8_t>(png[density + 4 + i]);
    EXPECT_NEAR(px_per_m, 10000, 500) << "fine enough to print";
    const cv::Mat sheet = cv::imdecode(cv::Mat(1, static_cast<int>(png.size()), CV_8U, const_cast<char*>(png.data())),
                                       cv::IMREAD_GRAYSCALE);
    ASSERT_FALSE(sheet.empty());
    GrayImage picture(sheet.cols, sheet.rows);
    std::copy(sheet.begin<std::uint8_t>(), sheet.end<std::uint8_t>(), picture.pixels.begin());
    const BoardCorners found = find_board(picture, board);
    ASSERT_EQ(found.size(), 54u);
    EXPECT_NEAR((found.pixels[8] - found.pixels[0]).norm() / px_per_m * 1000, 200, 0.02);
    EXPECT_EQ(sheet.at<std::uint8_t>(250 + 125, 250 + 125), kBoardDark);

    const std::string pdf = board_pdf(board);
    EXPECT_NE(pdf.find("/MediaBox [0 0 841.8898 595.2756]"), std::string::npos) << "A4 across";
    double x = 0, y = 0, w = 0, h = 0;
    const auto first = pdf.find(" g\n") + 3;
    ASSERT_EQ(std::sscanf(pdf.c_str() + first, "%lf %lf %lf %lf re", &x, &y, &w, &h), 4);
    EXPECT_NEAR(w * 25.4 / 72, 25, 1e-3);
    EXPECT_NEAR(x * 25.4 / 72, (297 - 250) / 2.0, 1e-3);
}

}  // namespace
}  // namespace planlight
