#include "tests/registration/calibration/real_captures.h"

#include <fmt/format.h>

#include <opencv2/core.hpp>

#include "planning_io/files/image_file.h"
#include "tests/support/test_data.h"

namespace planlight::test {

namespace {

CameraModel device(const cv::Mat& matrix, const cv::Mat& distortion, int width, int height) {
    CameraModel d;
    d.width = width;
    d.height = height;
    d.focal_x = matrix.at<double>(0, 0);
    d.focal_y = matrix.at<double>(1, 1);
    d.centre_x = matrix.at<double>(0, 2);
    d.centre_y = matrix.at<double>(1, 2);
    d.k1 = distortion.at<double>(0);
    d.k2 = distortion.at<double>(1);
    d.p1 = distortion.at<double>(2);
    d.p2 = distortion.at<double>(3);
    d.k3 = distortion.at<double>(4);
    return d;
}

}  // namespace

CalibrationSettings settings_for_real_captures() {
    CalibrationSettings settings;
    settings.max_predicted_mm = 3;
    return settings;
}

std::optional<RealCaptures> stereo_pairs() {
    const auto folder = third_party_data("stereo_calib");
    if (!folder) return std::nullopt;
    RealCaptures captures;
    captures.board = parse_board("chessboard 9x6 25 mm");
    for (const int i : {1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 12, 13, 14}) {
        const auto see = [&](const char* side) {
            const GrayImage picture = read_gray(*folder / fmt::format("{}{:02}.jpg", side, i));
            return observe_board({&picture, 1}, std::nullopt, captures.board);
        };
        captures.poses.push_back({fmt::format("{:02}", i), see("left"), see("right")});
    }
    const cv::FileStorage file((*folder / "left_intrinsics.yml").string(), cv::FileStorage::READ);
    cv::Mat matrix, distortion;
    file["camera_matrix"] >> matrix;
    file["distortion_coefficients"] >> distortion;
    captures.published.device(DeviceName::left_camera) = device(matrix, distortion, 640, 480);
    return captures;
}

std::optional<RealCaptures> camera_and_projector() {
    const auto folder = third_party_data("structured_light/procam_chessboard_gray");
    if (!folder) return std::nullopt;
    RealCaptures captures;
    captures.board = parse_board("chessboard 9x7 75 mm");
    // The published numbers are in pixels of which two make a cell of the code (their script's graycode_step): codes
    // run to 960 x 540, as of a 1920x1080 projector.
    captures.projector_width = 960;
    captures.projector_height = 540;
    StripeSettings gray;
    gray.width = captures.projector_width;
    gray.height = captures.projector_height;
    gray.phase_steps = 0;
    for (int pose = 0; pose < 3; ++pose) {
        std::vector<GrayImage> frames;
        for (const int i : {40, 41})
            frames.push_back(read_gray(*folder / fmt::format("capture_{}/graycode_{:02}.png", pose, i)));
        for (int i = 0; i < 40; ++i)
            frames.push_back(read_gray(*folder / fmt::format("capture_{}/graycode_{:02}.png", pose, i)));
        captures.poses.push_back({fmt::format("capture_{}", pose), observe_board(frames, gray, captures.board), {}});
    }
    const cv::FileStorage file((*folder / "calibration_result.xml").string(), cv::FileStorage::READ);
    cv::Mat camera, camera_distortion, projector, projector_distortion, turn, shift;
    file["cam_int"] >> camera;
    file["cam_dist"] >> camera_distortion;
    file["proj_int"] >> projector;
    file["proj_dist"] >> projector_distortion;
    file["roration"] >> turn;
    file["translation"] >> shift;
    captures.published.device(DeviceName::left_camera) = device(camera, camera_distortion, 1280, 1024);
    CameraModel p = device(projector, projector_distortion, 960, 540);
    for (double* v : {&p.focal_x, &p.focal_y, &p.centre_x, &p.centre_y}) *v /= 2;
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) p.device_from_rig.linear()(r, c) = turn.at<double>(r, c);
        p.device_from_rig.translation()[r] = shift.at<double>(r);
    }
    captures.published.device(DeviceName::projector) = p;
    return captures;
}

}  // namespace planlight::test
