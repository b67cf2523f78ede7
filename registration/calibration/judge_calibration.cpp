#include "registration/calibration/judge_calibration.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace planlight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr std::array kCameras{DeviceName::left_camera, DeviceName::right_camera};

bool has(const std::vector<PoseObservation>& poses, DeviceName camera) {
    return std::any_of(poses.begin(), poses.end(), [&](const PoseObservation& p) { return view_of(p, camera).width > 0; });
}

/// Off the plane: the corners' root mean square from the best homography, in squares. Lens distortion leaves a few hundredths.
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

std::optional<Refusal> judge_picture(const PoseObservation& pose, DeviceName camera, const BoardSpec& board,
                                     const CalibrationSettings& s) {
    const CameraObservation& seen = view_of(pose, camera);
    if (seen.corners.size() == 0) return std::nullopt;
    const std::string where = fmt::format("{}, {}", pose.name, text_of(camera));
    constexpr double kOffPlane = 0.15;
    if (const double off = off_plane(seen.corners, board); off > kOffPlane)
        return Refusal{fmt::format("{}: the corners do not lie as on a {} (off by {:.2f} squares)", where, text_of(board), off),
                       "Count the board's squares again (a chessboard by its inner corners), or flatten the board."};
    if (seen.saturated_share > s.max_saturated)
        return Refusal{
            fmt::format("{}: {:.0f} % of the board is saturated under white light", where, 100 * seen.saturated_share),
            "Expose less, or dim the projector, and capture again."};
    const double contrast = seen.coded_light ? seen.contrast_grey : seen.white_grey;
    if (contrast < s.min_contrast_grey)
        return Refusal{fmt::format("{}: the board is too dark ({:.0f} grey of light on it)", where, contrast),
                       "Expose longer, or dim the room, and capture again."};
    if (seen.moved_px > s.max_moved_px)
        return Refusal{
            fmt::format("{}: the board or the rig moved by {:.2f} px while the pose was captured", where, seen.moved_px),
            "Let the board stand by itself and capture this pose again."};
    if (seen.coded_light && seen.decoded_share < s.min_decoded)
        return Refusal{
            fmt::format("{}: only {:.0f} % of the lit board could be decoded", where, 100 * seen.decoded_share),
            "Check that every picture of the sequence was captured once and in its order, then capture this pose again."};
    return std::nullopt;
}

/// Of a camera's poses, those whose residual is far above the rest's.
std::string worst_poses(const std::vector<PoseObservation>& poses, const BundleResult& bundle, DeviceName device) {
    std::vector<double> all;
    for (const PoseResidual& r : bundle.residuals)
        if (r.device == device)
            all.push_back(r.used ? r.rms_px + 3.0 * static_cast<double>(r.left_out) / static_cast<double>(r.used + r.left_out)
                                 : 99);
    if (all.empty()) return "";
    std::vector<double> sorted = all;
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
    const double limit = 1.5 * sorted[sorted.size() / 2];
    std::vector<std::string> names;
    std::size_t i = 0;
    for (const PoseResidual& r : bundle.residuals)
        if (r.device == device && all[i++] > limit) names.push_back(poses[r.pose].name);
    if (names.empty() || names.size() > 6) return "";
    return fmt::format("; most of all {}", fmt::join(names, ", "));
}

double share_left_out(const BundleResult& bundle, DeviceName name) {
    const auto d = static_cast<std::size_t>(name);
    const auto all = static_cast<double>(bundle.used[d] + bundle.left_out[d]);
    return all > 0 ? static_cast<double>(bundle.left_out[d]) / all : 0;
}

double rms_of(const BundleResult& bundle, DeviceName name) {
    return bundle.rms_px[static_cast<std::size_t>(name)];
}

/// One camera adjusted by itself, as the left one of a rig.
BundleResult camera_alone(const std::vector<PoseObservation>& poses, const BoardSpec& board, DeviceName camera,
                          const CalibrationSettings& settings) {
    std::vector<PoseObservation> own = poses;
    for (PoseObservation& pose : own) {
        if (camera == DeviceName::right_camera) pose.left = pose.right;
        pose.right = {};
    }
    const StartValues start = find_camera_start(own, board);
    BundleSettings corners = settings.bundle;
    corners.light = false;
    return start.failure.empty() ? adjust_bundle(own, board, start.rig, corners) : BundleResult{};
}

/// What the right camera would have seen without its mirror. In a mirrored chessboard the corners are named from the other
/// side (one with a top: from below), so their names are turned back as well; the markers of a ChArUco board keep theirs.
BundleResult with_right_mirrored(const std::vector<PoseObservation>& poses, const BoardSpec& board,
                                 const CalibrationSettings& settings) {
    std::vector<PoseObservation> mirrored = poses;
    const int across = board.corners_across(), down = board.corners_down();
    for (PoseObservation& pose : mirrored)
        for (std::size_t i = 0; i < pose.right.corners.size(); ++i) {
            pose.right.corners.pixels[i].x() = pose.right.width - 1 - pose.right.corners.pixels[i].x();
            if (board.kind == BoardSpec::Kind::charuco) continue;
            int& id = pose.right.corners.ids[i];
            const int x = id % across, y = id / across;
            id = board.has_a_top() ? (down - 1 - y) * across + x : y * across + across - 1 - x;
        }
    const StartValues start = find_camera_start(mirrored, board);
    BundleSettings corners = settings.bundle;
    corners.light = false;
    return start.failure.empty() ? adjust_bundle(mirrored, board, start.rig, corners) : BundleResult{};
}

bool fits(const BundleResult& bundle, const CalibrationSettings& s) {
    return bundle.converged && std::all_of(kCameras.begin(), kCameras.end(), [&](DeviceName c) {
               return rms_of(bundle, c) <= s.max_rms_px && share_left_out(bundle, c) <= s.max_left_out;
           });
}

constexpr double kFloor_px = 0.02;  ///< below this a ratio of residuals says nothing

/// Each camera alone fits this much better than both together.
std::optional<Refusal> judge_pair(const std::vector<PoseObservation>& poses, const BoardSpec& board,
                                  const BundleResult& cameras, const CalibrationSettings& s) {
    if (!cameras.rig.device(DeviceName::right_camera)) return std::nullopt;
    for (const DeviceName camera : kCameras) {
        const BundleResult alone = camera_alone(poses, board, camera, s);
        const double by_itself = alone.sigma_px[0], together = cameras.sigma_px[static_cast<std::size_t>(camera)];
        if (alone.converged && together > s.max_worse_together * by_itself + kFloor_px)
            return Refusal{fmt::format("the {}'s corners fit to {:.2f} px by themselves, but to {:.2f} px together with the "
                                       "other camera's{}: a camera was moved between "
                                       "poses, or left and right pictures are not of the same moment",
                                       text_of(camera), by_itself, together, worst_poses(poses, cameras, camera)),
                           "Fix the cameras to the rig, then capture all poses again."};
    }
    return std::nullopt;
}

/// The median over the poses of how well a pose's light fits a projector that may stand anywhere.
double light_by_itself_px(const std::vector<PoseObservation>& poses, const BoardSpec& board, const RigEstimate& rig) {
    std::vector<double> misfits;
    for (std::size_t i = 0; i < poses.size(); ++i) {
        if (!rig.rig_from_board[i]) continue;
        std::vector<Vector3d> points;
        std::vector<Vector2d> pixels;
        for (const DeviceName camera : kCameras) {
            if (!rig.device(camera)) continue;
            for (const LightSample& sample : view_of(poses[i], camera).light)
                if (const auto p =
                        board_point(*rig.device(camera), sample.pixel_in_camera, *rig.rig_from_board[i], rig.bend_mm, board)) {
                    points.push_back(*rig.rig_from_board[i] * *p);
                    pixels.push_back(sample.pixel_in_projector);
                }
        }
        if (const auto misfit = misfit_anywhere(*rig.device(DeviceName::projector), points, pixels)) misfits.push_back(*misfit);
    }
    if (misfits.empty()) return 1e9;
    std::nth_element(misfits.begin(), misfits.begin() + static_cast<std::ptrdiff_t>(misfits.size() / 2), misfits.end());
    return misfits[misfits.size() / 2];
}

std::optional<Refusal> judge_lens(const CameraModel& d, DeviceName name) {
    const double by_width = d.focal_x / d.width, aspect = d.focal_x / d.focal_y;
    const std::string what = text_of(name);
    const char* remedy =
        "Capture more poses, tilted 15 to 40 degrees every way and at two distances, with zoom and focus fixed.";
    if (!(by_width > 0.3 && by_width < 12))
        return Refusal{fmt::format("the {}'s focal length comes out as {:.2f} picture widths", what, by_width), remedy};
    if (!(std::abs(aspect - 1) < 0.03))
        return Refusal{fmt::format("the {}'s pixels come out {:.1f} % wider than high", what, 100 * (1 / aspect - 1)), remedy};
    const double off_x = std::abs(d.centre_x / d.width - 0.5), off_y = std::abs(d.centre_y / d.height - 0.5);
    if (name != DeviceName::projector && (off_x > 0.3 || off_y > 0.3))
        return Refusal{fmt::format("the {}'s optical axis comes out at pixel {:.0f}, {:.0f}", what, d.centre_x, d.centre_y),
                       remedy};
    if (off_x > 3 || off_y > 3)
        return Refusal{fmt::format("the {}'s optical axis comes out at pixel {:.0f}, {:.0f}", what, d.centre_x, d.centre_y),
                       remedy};
    return std::nullopt;
}

}  // namespace

std::optional<Refusal> judge_pictures(const std::vector<PoseObservation>& poses, const BoardSpec& board,
                                      const CalibrationSettings& s) {
    for (const DeviceName camera : kCameras) {
        if (camera == DeviceName::right_camera && !has(poses, camera)) continue;
        std::size_t found = 0, mirrored = 0;
        for (const PoseObservation& pose : poses) {
            found += view_of(pose, camera).corners.size() > 0;
            mirrored += view_of(pose, camera).found_mirrored;
        }
        if (mirrored > found)
            return Refusal{fmt::format("the {}'s pictures are mirrored", text_of(camera)),
                           "Switch off the flip in the camera's settings and capture again."};
        if (found < s.least_poses)
            return Refusal{fmt::format("the {} sees a {} in {} of {} poses; {} are the least", text_of(camera), text_of(board),
                                       found, poses.size(), s.least_poses),
                           found == 0 ? "Check the board's kind and its count of squares (a chessboard by its inner corners)."
                                      : "Capture 10 to 15 poses that both cameras see."};
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
        most_tilted = std::max(most_tilted, std::acos(std::min(1.0, std::abs(normal.dot((*pose * middle).normalized())))));
        for (const auto& other : rig.rig_from_board)
            if (other) widest = std::max(widest, std::acos(std::min(1.0, std::abs(normal.dot(other->linear().col(2))))));
        const bool alike = std::any_of(distinct.begin(), distinct.end(), [&](const RigidTransform& d) {
            return angle_between(*pose, d) < s.alike_angle && (*pose * middle - d * middle).norm() < s.alike_mm;
        });
        if (!alike) distinct.push_back(*pose);
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
            fmt::format("the poses are too similar: their tilts differ by {:.0f} degrees at most", widest * kDegrees), remedy};
    }
    return std::nullopt;
}

std::optional<Refusal> judge_cameras(const std::vector<PoseObservation>& poses, const BoardSpec& board,
                                     const BundleResult& cameras, const CalibrationSettings& s) {
    if (!fits(cameras, s)) {
        for (const DeviceName camera : kCameras) {
            if (!cameras.rig.device(camera)) continue;
            const BundleResult alone = camera_alone(poses, board, camera, s);
            const double rms = rms_of(alone, DeviceName::left_camera), out = share_left_out(alone, DeviceName::left_camera);
            if (!alone.converged || rms > s.max_rms_px || out > s.max_left_out)
                return Refusal{
                    fmt::format("the {}'s corners do not fit one lens and a {} (off by {:.2f} px, {:.0f} % left out{})",
                                text_of(camera), text_of(board), rms, 100 * out,
                                worst_poses(poses, alone, DeviceName::left_camera)),
                    "Keep zoom, focus and resolution fixed, use a flat board, and check its count of squares."};
        }
        if (fits(with_right_mirrored(poses, board, s), s))
            return Refusal{"one camera's pictures are mirrored: the cameras fit each other only when one is turned round",
                           "Switch off the flip in that camera's settings and capture again."};
        return Refusal{fmt::format("each camera fits its own pictures, but together they are off by {:.2f} and {:.2f} px{}: a "
                                   "camera was moved between poses, or "
                                   "left and right pictures are of different poses",
                                   rms_of(cameras, DeviceName::left_camera), rms_of(cameras, DeviceName::right_camera),
                                   worst_poses(poses, cameras, DeviceName::right_camera)),
                       "Fix the cameras to the rig, then capture all poses again."};
    }
    if (auto refusal = judge_pair(poses, board, cameras, s)) return refusal;
    const auto& right = cameras.rig.device(DeviceName::right_camera);
    if (right && right->centre_in_rig().x() < 0)
        return Refusal{fmt::format("the right camera stands {:.0f} mm to the left of the left one: left and right are swapped",
                                   -right->centre_in_rig().x()),
                       "Exchange the left and right pictures (or the cameras' cables)."};
    for (const DeviceName camera : kCameras)
        if (const auto& d = cameras.rig.device(camera))
            if (auto refusal = judge_lens(*d, camera)) return refusal;
    return std::nullopt;
}

std::optional<Refusal> judge_rig(const std::vector<PoseObservation>& poses, const BoardSpec& board,
                                 const Calibration& calibration, const CalibrationSettings& s) {
    const BundleResult& bundle = calibration.bundle;
    if (!bundle.converged) return Refusal{"the adjustment of the rig did not settle", "Capture the poses again."};
    if (bundle.rig.device(DeviceName::projector)) {
        const double rms = rms_of(bundle, DeviceName::projector), out = share_left_out(bundle, DeviceName::projector);
        if (rms > s.max_rms_px || out > s.max_left_out)
            return Refusal{
                fmt::format("the light does not fit the board (off by {:.2f} px, {:.0f} % left out{}): projector or cameras "
                            "were moved between poses, "
                            "pictures of the sequence are late, or the projector's keystone correction is on",
                            rms, 100 * out, worst_poses(poses, bundle, DeviceName::projector)),
                "Fix all devices to the rig, switch keystone correction and digital zoom off, then capture all poses again."};
        if (const double by_itself = light_by_itself_px(poses, board, bundle.rig);
            rms > s.max_worse_together * by_itself + kFloor_px)
            return Refusal{fmt::format("the light of each pose fits to {:.2f} px by itself, that of all poses only to {:.2f} "
                                       "px{}: the projector, or a camera, was moved "
                                       "between poses",
                                       by_itself, rms, worst_poses(poses, bundle, DeviceName::projector)),
                           "Fix all devices to the rig, then capture all poses again."};
        if (!fits(bundle, s))
            return Refusal{"the cameras fit the board, but not together with the light",
                           "Fix all devices to the rig, then capture all poses again."};
    }
    for (const DeviceName name : kDevices)
        if (const auto& d = bundle.rig.device(name))
            if (auto refusal = judge_lens(*d, name)) return refusal;
    if (calibration.volume && !(calibration.volume->p95_mm <= s.max_predicted_mm))
        return Refusal{fmt::format("the poses do not determine the rig: points would be uncertain by {:.1f} mm",
                                   calibration.volume->p95_mm),
                       "Capture more poses, tilted 15 to 40 degrees every way and at two distances."};
    return std::nullopt;
}

std::vector<std::string> warnings_about(const std::vector<PoseObservation>& poses, const Calibration& calibration) {
    std::vector<std::string> warnings;
    const BundleResult& bundle = calibration.bundle;
    if (const auto count = bundle.rig.poses(); count < 8)
        warnings.push_back(fmt::format("{} poses; 10 to 15 are better", count));
    if (const std::size_t lost = poses.size() - bundle.rig.poses())
        warnings.push_back(fmt::format("the board was not found in {} of {} poses", lost, poses.size()));
    constexpr std::array kGoals_px{0.10, 0.10, 0.20};
    for (const DeviceName name : kDevices) {
        const auto d = static_cast<std::size_t>(name);
        if (bundle.rig.devices[d] && calibration.held_out.rms_px[d] > kGoals_px[d])
            warnings.push_back(fmt::format("{}: {:.2f} px on held-out poses; the goal is {:.2f}", text_of(name),
                                           calibration.held_out.rms_px[d], kGoals_px[d]));
        if (bundle.rig.devices[d] && share_left_out(bundle, name) > 0.08)
            warnings.push_back(
                fmt::format("{}: {:.0f} % left out as wrong", text_of(name), 100 * share_left_out(bundle, name)));
    }
    if (const auto& p = bundle.rig.device(DeviceName::projector); p && std::abs(p->focal_x / p->focal_y - 1) > 0.01)
        warnings.push_back(
            fmt::format("the projector's pixels are {:.1f} % off square: is keystone correction or digital zoom on?",
                        100 * (p->focal_x / p->focal_y - 1)));
    if (const double bend = bundle.rig.bend_mm.cwiseAbs().maxCoeff(); bend > 0.5)
        warnings.push_back(fmt::format("the board is bent by {:.1f} mm; glue it on a flat plate", bend));
    return warnings;
}

}  // namespace planlight
