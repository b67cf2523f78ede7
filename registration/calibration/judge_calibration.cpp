#include "registration/calibration/judge_calibration.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "planning_io/types/statistics.h"
#include "registration/calibration/board_stretch.h"
#include "registration/calibration/camera_fits.h"
#include "registration/calibration/odd_poses.h"

namespace planlight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Of a camera's poses, those whose residual is far above the rest's.
std::string worst_poses(const std::vector<PoseObservation>& poses, const BundleResult& bundle, DeviceName device) {
    std::vector<double> all;
    for (const PoseResidual& r : bundle.residuals)
        if (r.device == device)
            all.push_back(r.used ? r.rms_px +
                                       3.0 * static_cast<double>(r.left_out) / static_cast<double>(r.used + r.left_out)
                                 : 99);
    if (all.empty()) return "";
    const double limit = 1.5 * median(all);
    std::vector<std::string> names;
    std::size_t i = 0;
    for (const PoseResidual& r : bundle.residuals)
        if (r.device == device && all[i++] > limit) names.push_back(poses[r.pose].name);
    if (names.empty() || names.size() > 6) return "";
    return fmt::format("; most of all {}", fmt::join(names, ", "));
}

/// What is off is left out of the residuals: the larger of the two tells.
std::string misfit_together(const BundleResult& cameras, const CalibrationSettings& s) {
    const double left = rms_of(cameras, DeviceName::left_camera), right = rms_of(cameras, DeviceName::right_camera);
    if (std::max(left, right) > s.max_rms_px) return fmt::format("they are off by {:.2f} and {:.2f} px", left, right);
    const double out =
        std::max(share_left_out(cameras, DeviceName::left_camera), share_left_out(cameras, DeviceName::right_camera));
    return fmt::format("{:.0f} % of the corners do not fit", 100 * out);
}

/// What the right camera would have seen without its mirror. In a mirrored chessboard the corners are named from the
/// other side (one with a top: from below), so their names are turned back as well; the markers of a ChArUco board keep
/// theirs.
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
    mirrored = named_as_left(std::move(mirrored), board);
    return adjust_corners(mirrored, board, settings);
}

std::optional<Refusal> judge_pair(const std::vector<PoseObservation>& poses, const BoardSpec& board,
                                  const BundleResult& cameras, const CalibrationSettings& s) {
    const auto worse = worse_together(poses, board, cameras, s);
    if (!worse) return std::nullopt;
    if (auto refusal = judge_stretch(poses, board, cameras, s)) return refusal;
    return Refusal{fmt::format("the {}'s corners fit to {:.2f} px by themselves, but to {:.2f} px together with the "
                               "other camera's{}: a camera was moved between "
                               "poses, or left and right pictures are not of the same moment",
                               text_of(worse->camera), worse->by_itself_px, worse->together_px,
                               worst_poses(poses, cameras, worse->camera)),
                   "Fix the cameras to the rig, then capture all poses again."};
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
                if (const auto p = board_point(*rig.device(camera), sample.pixel_in_camera, *rig.rig_from_board[i],
                                               rig.bend_mm, board)) {
                    points.push_back(*rig.rig_from_board[i] * *p);
                    pixels.push_back(sample.pixel_in_projector);
                }
        }
        if (const auto misfit = misfit_anywhere(*rig.device(DeviceName::projector), points, pixels))
            misfits.push_back(*misfit);
    }
    if (misfits.empty()) return 1e9;
    return median(std::move(misfits));
}

std::optional<Refusal> judge_lens(const CameraModel& d, DeviceName name) {
    const double by_width = d.focal_x / d.width, aspect = d.focal_x / d.focal_y;
    const std::string what = text_of(name);
    const char* remedy =
        "Capture more poses, tilted 15 to 40 degrees every way and at two distances, with zoom and focus fixed.";
    if (!(by_width > 0.3 && by_width < 12))
        return Refusal{fmt::format("the {}'s focal length comes out as {:.2f} picture widths", what, by_width), remedy};
    if (!(std::abs(aspect - 1) < 0.03))
        return Refusal{
            fmt::format("the {}'s pixels come out {:.1f} % {} than high", what, 100 * std::abs(1 / aspect - 1),
                        aspect < 1 ? "wider" : "narrower"),
            name == DeviceName::projector
                ? "Give the projector pictures of its own resolution, with scaling, zoom and keystone correction off "
                  "(\"1:1\", \"native\"), and capture again."
                : "Switch binning and decimation off, or alike in both directions, see that the board's squares are as "
                  "high as wide, and capture again."};
    const double off_x = std::abs(d.centre_x / d.width - 0.5), off_y = std::abs(d.centre_y / d.height - 0.5);
    if (name != DeviceName::projector && (off_x > 0.3 || off_y > 0.3))
        return Refusal{
            fmt::format("the {}'s optical axis comes out at pixel {:.0f}, {:.0f} of {} x {}", what, d.centre_x,
                        d.centre_y, d.width, d.height),
            "If the camera sends a part of its sensor, cut it round the middle; else capture more poses, tilted 15 to "
            "40 degrees every way and at two distances, with zoom and focus fixed."};
    if (off_x > 3 || off_y > 3)
        return Refusal{
            fmt::format("the {}'s optical axis comes out at pixel {:.0f}, {:.0f}", what, d.centre_x, d.centre_y),
            remedy};
    return std::nullopt;
}

/// Of a camera that is upright to the left one and beside it. Of cameras that are rolled against each other or stand
/// one above the other, none is the left one by its pictures.
bool stands_on_the_left(const CameraModel& right) {
    const double kUpright = std::cos(std::numbers::pi / 4);
    const Vector3d centre = right.centre_in_rig();
    const bool beside = std::abs(centre.x()) >= std::max(std::abs(centre.y()), std::abs(centre.z()));
    return beside && right.device_from_rig.linear()(0, 0) > kUpright && centre.x() < 0;
}

}  // namespace

std::optional<Refusal> judge_cameras(const std::vector<PoseObservation>& poses, const BoardSpec& board,
                                     const BundleResult& cameras, const CalibrationSettings& s) {
    if (!cameras_fit(cameras, s)) {
        if (auto refusal = judge_stretch(poses, board, cameras, s)) return refusal;
        for (const DeviceName camera : kCameras) {
            if (!cameras.rig.device(camera)) continue;
            const BundleResult alone = camera_alone(poses, board, camera, s);
            const double rms = rms_of(alone, DeviceName::left_camera),
                         out = share_left_out(alone, DeviceName::left_camera);
            if (!alone.converged || rms > s.max_rms_px || out > s.max_left_out)
                return Refusal{
                    fmt::format("the {}'s corners do not fit one lens and a {} (off by {:.2f} px, {:.0f} % left out{})",
                                text_of(camera), text_of(board), rms, 100 * out,
                                worst_poses(poses, alone, DeviceName::left_camera)),
                    "Keep zoom, focus and resolution fixed, use a flat board, and check its count of squares."};
        }
        if (cameras_fit(with_right_mirrored(poses, board, s), s))
            return Refusal{
                "one camera's pictures are mirrored: the cameras fit each other only when one is turned round",
                "Switch off the flip in that camera's settings and capture again."};
        return Refusal{
            fmt::format("each camera fits its own pictures, but together {}{}: a camera was moved between poses, or "
                        "left and right pictures are of different poses",
                        misfit_together(cameras, s), worst_poses(poses, cameras, DeviceName::right_camera)),
            "Fix the cameras to the rig, then capture all poses again."};
    }
    if (auto refusal = judge_pair(poses, board, cameras, s)) return refusal;
    BundleSettings corners = s.bundle;
    corners.light = false;
    if (auto refusal = judge_odd_poses(poses, board, cameras, corners)) return refusal;
    const auto& right = cameras.rig.device(DeviceName::right_camera);
    if (right && stands_on_the_left(*right))
        return Refusal{
            fmt::format("the right camera stands {:.0f} mm to the left of the left one: left and right are swapped",
                        -right->centre_in_rig().x()),
            "Exchange the left and right pictures (or the cameras' cables); if they are right, the pictures of both "
            "are mirrored: switch that off (writing held before a camera must be readable)."};
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
                fmt::format(
                    "the light does not fit the board (off by {:.2f} px, {:.0f} % left out{}): projector or cameras "
                    "were moved between poses, "
                    "pictures of the sequence are late, or the projector's keystone correction is on",
                    rms, 100 * out, worst_poses(poses, bundle, DeviceName::projector)),
                "Fix all devices to the rig, switch keystone correction and digital zoom off, then capture all poses "
                "again."};
        if (const double by_itself = light_by_itself_px(poses, board, bundle.rig);
            rms > s.max_worse_together * by_itself + kResidualFloor_px)
            return Refusal{
                fmt::format("the light of each pose fits to {:.2f} px by itself, that of all poses only to {:.2f} "
                            "px{}: the projector, or a camera, was moved "
                            "between poses",
                            by_itself, rms, worst_poses(poses, bundle, DeviceName::projector)),
                "Fix all devices to the rig, then capture all poses again."};
        if (!cameras_fit(bundle, s))
            return Refusal{"the cameras fit the board, but not together with the light",
                           "Fix all devices to the rig, then capture all poses again."};
        if (auto refusal = judge_odd_poses(poses, board, bundle, s.bundle)) return refusal;
    }
    for (const DeviceName name : kDevices)
        if (const auto& d = bundle.rig.device(name))
            if (auto refusal = judge_lens(*d, name)) return refusal;
    if (const double stretch = board_stretch(bundle.rig); std::abs(stretch) > s.max_board_stretch)
        return Refusal{said_of_stretch(stretch), kStretchRemedy};
    if (!calibration.volume) return std::nullopt;
    const VolumeError& volume = *calibration.volume;
    for (const auto& [what, p95_mm] : {std::pair("points", volume.p95_mm), {"the light", volume.light_p95_mm}})
        if (!(p95_mm <= s.max_predicted_mm))
            return Refusal{
                fmt::format("the poses do not determine the rig: {} would be uncertain by {:.1f} mm", what, p95_mm),
                "Capture more poses, tilted 15 to 40 degrees every way and at two distances."};
    return std::nullopt;
}

/// Median distance of the boards' origins from the left camera, mm, which a wrong square scales; 0 without a pose.
double board_distance_mm(const RigEstimate& rig) {
    std::vector<double> distances;
    for (const auto& pose : rig.rig_from_board)
        if (pose) distances.push_back(pose->translation().norm());
    return distances.empty() ? 0 : median(distances);
}

std::vector<std::string> warnings_about(const std::vector<PoseObservation>& poses, const Calibration& calibration) {
    std::vector<std::string> warnings;
    const BundleResult& bundle = calibration.bundle;
    if (const auto count = bundle.rig.poses(); count < 8)
        warnings.push_back(fmt::format("{} poses; 10 to 15 are better", count));
    if (const std::size_t lost = poses.size() - bundle.rig.poses())
        warnings.push_back(fmt::format("the board was not found in {} of {} poses", lost, poses.size()));
    constexpr double kGood_mm = 0.3;
    if (const auto& v = calibration.volume; v && std::max(v->p95_mm, v->light_p95_mm) > kGood_mm)
        warnings.push_back(fmt::format(
            "the poses leave the rig uncertain: 95 % of the points by up to {:.2f} mm, of the light by up to {:.2f} "
            "mm; capture more poses, tilted every way and at two distances",
            v->p95_mm, v->light_p95_mm));
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
    constexpr double kAside = 0.05;  // of its width; upwards many projectors throw their picture, sideways few
    if (const auto& p = bundle.rig.device(DeviceName::projector); p && std::abs(p->centre_x / p->width - 0.5) > kAside)
        warnings.push_back(fmt::format(
            "the projector's optical axis lies at column {:.0f} of {}: if its lens is not shifted sideways, "
            "its patterns were of another period than capture.json says, or its picture is scaled; at the "
            "board's distance ({:.0f} mm) its picture is {:.0f} mm wide by this calibration: measure it",
            p->centre_x, p->width, board_distance_mm(bundle.rig),
            board_distance_mm(bundle.rig) * p->width / p->focal_x));
    constexpr double kSquare = 0.002;  // of good boards a ten-thousandth
    if (const double stretch = board_stretch(bundle.rig); std::abs(stretch) > kSquare)
        warnings.push_back(said_of_stretch(stretch) + "; measure its width and its height");
    if (const double bend = bundle.rig.bend_mm.cwiseAbs().maxCoeff(); bend > 0.5)
        warnings.push_back(fmt::format("the board is bent by {:.1f} mm; glue it on a flat plate", bend));
    constexpr double kNearest_mm = 250, kFarthest_mm = 3500;
    if (const double mm = board_distance_mm(bundle.rig); mm > 0 && (mm < kNearest_mm || mm > kFarthest_mm))
        warnings.push_back(
            fmt::format("the board stood {:.0f} mm from the left camera by this calibration; if that is not so, its "
                        "squares are not as large as was said",
                        mm));
    return warnings;
}

}  // namespace planlight
