#include "registration/calibration/find_board.h"

#include <algorithm>
#include <cmath>
#include <opencv2/aruco.hpp>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "registration/calibration/refine_corners.h"

namespace planlight {
namespace {

using Eigen::Vector2d;

BoardCorners find_charuco(const cv::Mat& picture, const BoardSpec& spec) {
    const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_100);
    const auto board = cv::aruco::CharucoBoard::create(spec.columns, spec.rows, 8, 6, dictionary);
    const auto parameters = cv::aruco::DetectorParameters::create();
    parameters->adaptiveThreshWinSizeMax = 53;
    std::vector<std::vector<cv::Point2f>> markers;
    std::vector<int> marker_ids;
    cv::aruco::detectMarkers(picture, dictionary, markers, marker_ids, parameters);
    BoardCorners found;
    if (marker_ids.size() < 3) return found;
    std::vector<cv::Point2f> corners;
    std::vector<int> ids;
    cv::aruco::interpolateCornersCharuco(markers, marker_ids, picture, board, corners, ids);
    std::vector<std::size_t> order(ids.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return ids[a] < ids[b]; });
    for (const std::size_t i : order) {
        found.ids.push_back(ids[i]);
        found.pixels.emplace_back(corners[i].x, corners[i].y);
    }
    return found;
}

double mean_grey(const cv::Mat& picture, const Vector2d& at) {
    const int x = static_cast<int>(std::lround(at.x())), y = static_cast<int>(std::lround(at.y()));
    const cv::Rect box = cv::Rect(x - 2, y - 2, 5, 5) & cv::Rect(0, 0, picture.cols, picture.rows);
    return box.empty() ? 0 : cv::mean(picture(box))[0];
}

/// Corner (0,0) is the one whose inner square is dark (the first square, its diagonal neighbour, is dark as well).
bool upside_down(const cv::Mat& picture, const BoardCorners& found, const BoardSpec& spec) {
    const auto n = static_cast<std::size_t>(spec.corners_across());
    const auto& p = found.pixels;
    if (!spec.has_a_top()) return p.front().sum() > p.back().sum();
    double inner = 0, beside = 0;
    for (std::size_t i = 0; i + 2 < n; i += 2) {
        inner += mean_grey(picture, (p[i] + p[i + 1] + p[n + i] + p[n + i + 1]) / 4);
        beside += mean_grey(picture, (p[i + 1] + p[i + 2] + p[n + i + 1] + p[n + i + 2]) / 4);
    }
    return inner > beside;
}

BoardCorners find_chessboard(const cv::Mat& picture, const BoardSpec& spec) {
    std::vector<cv::Point2f> corners;
    const cv::Size size(spec.columns, spec.rows);
    if (!cv::findChessboardCornersSB(picture, size, corners, cv::CALIB_CB_ACCURACY | cv::CALIB_CB_NORMALIZE_IMAGE) &&
        !cv::findChessboardCorners(picture, size, corners, cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE))
        return {};
    BoardCorners found;
    for (int i = 0; i < spec.corner_count(); ++i) {
        found.ids.push_back(i);
        found.pixels.emplace_back(corners[static_cast<std::size_t>(i)].x, corners[static_cast<std::size_t>(i)].y);
    }
    if (upside_down(picture, found, spec)) std::reverse(found.pixels.begin(), found.pixels.end());
    return found;
}

}  // namespace

BoardCorners find_board(const GrayImage& picture, const BoardSpec& board) {
    if (picture.empty()) return {};
    const cv::Mat view(picture.height, picture.width, CV_8UC1, const_cast<std::uint8_t*>(picture.pixels.data()));
    try {
        BoardCorners found =
            board.kind == BoardSpec::Kind::charuco ? find_charuco(view, board) : find_chessboard(view, board);
        refine_corners(picture, board, found);
        return found;
    } catch (const cv::Exception&) {  // pictures of a few pixels
        return {};
    }
}

bool spans_a_plane(const BoardCorners& corners, const BoardSpec& board) {
    std::set<int> across, down;
    for (const int id : corners.ids) {
        across.insert(id % board.corners_across());
        down.insert(id / board.corners_across());
    }
    return corners.size() >= 6 && across.size() >= 2 && down.size() >= 2;
}

BoardCorners follow_board(const GrayImage& picture, const BoardCorners& corners, const BoardSpec& board) {
    BoardCorners found = corners;
    refine_corners(picture, board, found);
    return found;
}

}  // namespace planlight
