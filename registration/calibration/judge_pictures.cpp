#include "registration/calibration/judge_pictures.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "registration/devices/colour_mosaic.h"

namespace planlight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kDegrees = 180 / std::numbers::pi;

bool has(const std::vector<PoseObservation>& poses, DeviceName camera) {
    return std::any_of(poses.begin(), poses.end(),
                       [&](const PoseObservation& p) { return view_of(p, camera).width > 0; });
}

/// Off the plane: the corners' root mean square from the best homography, in squares. Lens distortion leaves a few
/// hundredths.
double off_plane(const BoardCorners& corners, const BoardSpec& board) {
    const auto count = static_cast<Eigen::Index>(corners.size());
    Vector2d middle = Vector2d::Zero();
    for (const Vector2d& p : corners.pixels) middle += p / static_cast<double>(count);
    double spread = 1e-9;
    for (const Vector2d& p : corners.pixels) spread += (p - middle).norm() / static_cast<double>(count);
    const Vector2d board_middle(board.width_mm() / 2, board.height_mm() / 2);
    const auto on_board = [&](std::size_t i) -> Vector2d {
        return (board.corner_in_board(corners.ids[i]).head<2>() - board_middle) / board.width_mm();
    };
    Eigen::MatrixXd rows(2 * count, 9);
    for (Eigen::Index i = 0; i < count; ++i) {
        const Vector2d b = on_board(static_cast<std::size_t>(i));
        const Vector3d p = ((corners.pixels[static_cast<std::size_t>(i)] - middle) / spread).homogeneous();
        rows.row(2 * i) << p.transpose(), 0, 0, 0, -b.x() * p.transpose();
        rows.row(2 * i + 1) << 0, 0, 0, p.transpose(), -b.y() * p.transpose();
    }
    const Eigen::Matrix<double, 9, 9> square = rows.transpose() * rows;
    const Eigen::Matrix<double, 9, 1> h =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>>(square).eigenvectors().col(0);
    Eigen::Matrix3d H;
    H << h.segment<3>(0).transpose(), h.segment<3>(3).transpose(), h.segment<3>(6).transpose();
    double sum = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vector3d p = ((corners.pixels[i] - middle) / spread).homogeneous();
        sum += ((H * p).hnormalized() - on_board(i)).squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(count)) * board.width_mm() / board.square_mm;
}

/// What may be wrong with a board of which the pictures show another, or none.
std::string counted_again(const BoardSpec& board) {
    if (board.kind == BoardSpec::Kind::chessboard)
        return "Check the board's kind and its count of squares (a chessboard by its inner corners).";
    return "Check the board's kind and its count of squares; its markers must be of the dictionary DICT_4X4 and begin "
           "as "
           "those of `planlight board` (boards of other programs may begin with a marker in the corner).";
}

std::optional<Refusal> judge_picture(const PoseObservation& pose, DeviceName camera, const BoardSpec& board,
                                     const CalibrationSettings& s) {
    const CameraObservation& seen = view_of(pose, camera);
    const std::string where = fmt::format("{}, {}", pose.name, text_of(camera));
    if (seen.colour_mosaic)
        return Refusal{
            fmt::format("{}: these are raw pictures of a colour camera: every second pixel is brighter", where),
            kColourMosaicRemedy};
    if (seen.corners.size() == 0) return std::nullopt;
    // A lens bends the board by a share of its width, however small its squares are.
    constexpr double kOffPlane = 0.15, kOffPlaneByColumns = 0.015;
    if (const double off = off_plane(seen.corners, board);
        off > std::max(kOffPlane, kOffPlaneByColumns * board.columns))
        return Refusal{
            fmt::format("{}: the corners do not lie as on a {} (off by {:.2f} squares)", where, text_of(board), off),
            counted_again(board) + " Or flatten the board."};
    if (seen.saturated_share > s.max_saturated)
        return Refusal{
            fmt::format("{}: {:.0f} % of the board is saturated under white light", where, 100 * seen.saturated_share),
            "Expose less, or dim the projector, and capture again."};
    const double contrast = seen.coded_light ? seen.contrast_grey : seen.white_grey;
    if (contrast < s.min_contrast_grey)
        return Refusal{fmt::format("{}: the board is too dark ({:.0f} grey of light on it)", where, contrast),
                       "Expose longer, or dim the room, and capture again."};
    if (seen.moved_px > s.max_moved_px)
        return Refusal{fmt::format("{}: the board or the rig moved by {:.2f} px while the pose was captured", where,
                                   seen.moved_px),
                       "Let the board stand by itself and capture this pose again."};
    if (!seen.wrong_sequence.empty())
        return Refusal{
            fmt::format("{}: the frames do not show the sequence: {}", where, seen.wrong_sequence),
            seen.sequence_remedy.empty()
                ? "Capture this pose again; if it comes back, check the delay between projector and cameras and the "
                  "names of the pictures. \"check_sequence\": false in capture.json takes them as they are."
                : seen.sequence_remedy};
    if (seen.coded_light && seen.decoded_share < s.min_decoded)
        return Refusal{
            fmt::format("{}: only {:.0f} % of the lit board could be decoded", where, 100 * seen.decoded_share),
            "Check that every picture of the sequence was captured once and in its order, then capture this pose "
            "again."};
    return std::nullopt;
}

/// More often so than as it is.
bool mostly_mirrored(const std::vector<PoseObservation>& poses, DeviceName camera) {
    std::ptrdiff_t more = 0;
    for (const PoseObservation& pose : poses)
        more += view_of(pose, camera).found_mirrored - (view_of(pose, camera).corners.size() > 0);
    return more > 0;
}

}  // namespace

std::optional<Refusal> judge_pose_pictures(const PoseObservation& pose, const BoardSpec& board,
                                           const CalibrationSettings& settings) {
    for (const DeviceName camera : kCameras)
        if (auto refusal = judge_picture(pose, camera, board, settings)) return refusal;
    return std::nullopt;
}

std::optional<Refusal> judge_pictures(const std::vector<PoseObservation>& poses, const BoardSpec& board,
                                      const CalibrationSettings& s) {
    for (const PoseObservation& pose : poses)
        for (const DeviceName camera : kCameras)
            if (view_of(pose, camera).colour_mosaic) return judge_picture(pose, camera, board, s);
    for (const DeviceName camera : kCameras) {
        if (camera == DeviceName::right_camera && !has(poses, camera)) continue;
        const auto found = static_cast<std::size_t>(std::count_if(
            poses.begin(), poses.end(), [&](const auto& pose) { return view_of(pose, camera).corners.size() > 0; }));
        if (mostly_mirrored(poses, DeviceName::left_camera) && mostly_mirrored(poses, DeviceName::right_camera))
            return Refusal{
                "both cameras see the board mirrored: it was printed mirrored, or both pictures are flipped",
                "Hold a page with writing before the cameras: where it can be read, print the board anew "
                "without mirroring; else switch off the flip in the settings of both cameras. Capture again."};
        if (mostly_mirrored(poses, camera))
            return Refusal{fmt::format("the {}'s pictures are mirrored", text_of(camera)),
                           "Switch off the flip in the camera's settings and capture again."};
        if (found < s.least_poses)
            return Refusal{fmt::format("the {} sees a {} in {} of {} poses; {} are the least", text_of(camera),
                                       text_of(board), found, poses.size(), s.least_poses),
                           found == 0 ? counted_again(board) : "Capture 10 to 15 poses that both cameras see."};
    }
    int width[2] = {}, height[2] = {};
    for (const PoseObservation& pose : poses)
        for (const DeviceName camera : kCameras) {
            const CameraObservation& seen = view_of(pose, camera);
            const auto c = static_cast<std::size_t>(camera);
            if (seen.width > 0 && width[c] == 0) width[c] = seen.width, height[c] = seen.height;
            if (seen.width > 0 && (seen.width != width[c] || seen.height != height[c]))
                return Refusal{fmt::format("{}, {}: {} x {} pixels, the first pose {} x {}", pose.name, text_of(camera),
                                           seen.width, seen.height, width[c], height[c]),
                               "Capture all poses with the same camera settings."};
            if (auto refusal = judge_picture(pose, camera, board, s)) return refusal;
        }
    return std::nullopt;
}

std::optional<Refusal> judge_poses(const RigEstimate& rig, const BoardSpec& board, const CalibrationSettings& s) {
    std::vector<RigidTransform> distinct;
    double widest = 0, most_tilted = 0;
    const Vector3d middle(board.width_mm() / 2, board.height_mm() / 2, 0);
    for (const auto& pose : rig.rig_from_board) {
        if (!pose) continue;
        const Vector3d normal = pose->linear().col(2);
        most_tilted =
            std::max(most_tilted, std::acos(std::min(1.0, std::abs(normal.dot((*pose * middle).normalized())))));
        for (const auto& other : rig.rig_from_board)
            if (other)
                widest = std::max(widest, std::acos(std::min(1.0, std::abs(normal.dot(other->linear().col(2))))));
        const bool seen_before = std::any_of(distinct.begin(), distinct.end(), [&](const RigidTransform& d) {
            return angle_between(*pose, d) < s.alike_angle && (*pose * middle - d * middle).norm() < s.alike_mm;
        });
        if (!seen_before) distinct.push_back(*pose);
    }
    const char* remedy = "Tilt the board 15 to 40 degrees, every way, and vary its distance.";
    if (distinct.size() < s.least_poses)
        return Refusal{fmt::format("the {} poses are only {} different ones", rig.poses(), distinct.size()), remedy};
    if (widest < s.least_tilt_range) {
        if (most_tilted < 0.5 * s.least_tilt_range + 0.05)
            return Refusal{fmt::format("the board is nearly flat on in all poses (tilted by {:.0f} degrees at most)",
                                       most_tilted * kDegrees),
                           remedy};
        return Refusal{
            fmt::format("the poses are too similar: their tilts differ by {:.0f} degrees at most", widest * kDegrees),
            remedy};
    }
    return std::nullopt;
}

}  // namespace planlight
