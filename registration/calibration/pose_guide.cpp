#include "registration/calibration/pose_guide.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "planning_io/types/statistics.h"

namespace planlight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kDegrees = 180 / std::numbers::pi;

/// Median movement of the corners that both show, pixels; empty when there are too few.
std::optional<double> movement(const BoardCorners& before, const BoardCorners& now) {
    std::vector<double> moved;
    for (std::size_t i = 0, k = 0; i < before.size() && k < now.size();) {
        if (before.ids[i] < now.ids[k])
            ++i;
        else if (now.ids[k] < before.ids[i])
            ++k;
        else
            moved.push_back((before.pixels[i++] - now.pixels[k++]).norm());
    }
    constexpr std::size_t kLeast = 4;
    if (moved.size() < kLeast) return std::nullopt;
    return median(std::move(moved));
}

Vector3d middle_of(const BoardSpec& board) {
    return {board.width_mm() / 2, board.height_mm() / 2, 0};
}

double angle_between_faces(const BoardStance& a, const BoardStance& b) {
    return angle_between(a.left_from_board, b.left_from_board);
}

}  // namespace

PoseGuide::PoseGuide(const BoardSpec& board, const PoseGuideSettings& settings) : board_(board), settings_(settings) {}

/// Of the calibration so far, or guessed from all that was seen.
std::pair<CameraModel, CameraModel> PoseGuide::lenses(const BoardSighting& now) const {
    if (rig_) return {*rig_->device(DeviceName::left_camera), *rig_->device(DeviceName::right_camera)};
    constexpr std::size_t kViews = 4;
    std::vector<BoardCorners> left, right;
    const std::size_t first = poses_.size() > kViews ? poses_.size() - kViews : 0;
    for (std::size_t i = first; i < poses_.size(); ++i) {
        left.push_back(poses_[i].left);
        right.push_back(poses_[i].right);
    }
    if (now.left.corners.size() > 0) left.push_back(now.left.corners);
    if (now.right.corners.size() > 0) right.push_back(now.right.corners);
    return {guessed_camera(left, board_, now.left.width, now.left.height),
            guessed_camera(right, board_, now.right.width, now.right.height)};
}

/// How much of the time that it must be at rest it has been. A board that one camera sees is judged by that one.
double PoseGuide::still_share(const BoardSighting& now) {
    const auto at_rest = [&](const BoardSighting& before) {
        const auto left = movement(before.left.corners, now.left.corners),
                   right = movement(before.right.corners, now.right.corners);
        if (!left && !right) return false;
        return left.value_or(0) < settings_.still_px && right.value_or(0) < settings_.still_px;
    };
    std::size_t moved_until = 0;
    for (std::size_t i = 0; i < recent_.size(); ++i)
        if (!at_rest(recent_[i])) moved_until = i + 1;
    recent_.erase(recent_.begin(), recent_.begin() + static_cast<std::ptrdiff_t>(moved_until));
    recent_.push_back(now);
    constexpr std::size_t kMost = 200;
    if (recent_.size() > kMost) recent_.erase(recent_.begin() + 1);  // the first says since when
    const double time = seconds(now.at - recent_.front().at) / seconds(settings_.still_for),
                 frames = static_cast<double>(recent_.size()) / static_cast<double>(settings_.still_frames);
    return std::clamp(std::min(time, frames), 0.0, 1.0);
}

PoseFault PoseGuide::fault_of_view(const BoardView& view, const char* camera, PoseAdvice& advice) const {
    const auto fault = [&](PoseFault which, std::string why, std::string what, std::string in_light) {
        advice.why = std::move(why);
        advice.what = std::move(what);
        advice.in_light = std::move(in_light);
        return which;
    };
    const double share = static_cast<double>(view.corners.size()) / board_.corner_count();
    if (share < settings_.least_corners)
        return fault(PoseFault::in_part,
                     fmt::format("The {} camera sees only {:.0f} % of the board.", camera, 100 * share),
                     fmt::format("Bring it farther into the {} picture, and let nothing cover it.", camera),
                     "MORE INTO THE PICTURE");
    if (view.saturated_share > settings_.max_saturated)
        return fault(PoseFault::too_bright,
                     fmt::format("The board is too bright for the {} camera ({:.0f} % of it saturated).", camera,
                                 100 * view.saturated_share),
                     "Take it farther from the projector, or shorten the exposure.", "TOO BRIGHT");
    if (view.contrast_grey < settings_.least_contrast_grey)
        return fault(PoseFault::too_dark,
                     fmt::format("The board is too dark for the {} camera (paper {:.0f} of 255, print {:.0f} darker).",
                                 camera, view.paper_grey, view.contrast_grey),
                     "Bring it into the projector's light, or lengthen the exposure.", "TOO DARK");
    if (view.blur_px > settings_.max_blur_px)
        return fault(PoseFault::blurred,
                     fmt::format("The board is blurred in the {} picture ({:.1f} pixels).", camera, view.blur_px),
                     "Bring it to where the patient will be; if it is blurred there, focus the camera.", "BLURRED");
    return PoseFault::none;
}

/// Share of the board's corners that the projector can light, by the calibration so far; 1 while that is not known.
double PoseGuide::share_in_light(const BoardStance& stance) const {
    if (!rig_ || !rig_->device(DeviceName::projector)) return 1;
    const CameraModel& projector = *rig_->device(DeviceName::projector);
    const RigidTransform rig_from_board =
        rig_->device(DeviceName::left_camera)->device_from_rig.inverse() * stance.left_from_board;
    int lit = 0;
    for (int id = 0; id < board_.corner_count(); ++id) {
        const auto pixel = project(projector, rig_from_board * board_.corner_in_board(id));
        lit += pixel && in_picture(projector, *pixel);
    }
    return static_cast<double>(lit) / board_.corner_count();
}

double PoseGuide::usual_distance_mm() const {
    return median(coverage_.distances_mm);
}

PoseFault PoseGuide::fault_of_stance(const BoardStance& stance, PoseAdvice& advice) const {
    if (stance.steepest > settings_.steepest) {
        advice.why = fmt::format("A camera looks onto it too far aslant ({:.0f} degrees).", stance.steepest * kDegrees);
        advice.what = "Turn its face towards the cameras, until it is tilted by 20 to 35 degrees.";
        advice.in_light = "LESS TILT";
        return PoseFault::aslant;
    }
    if (const double usual = usual_distance_mm(); usual > 0) {
        const double off_mm = stance.distance_mm - usual;
        if (std::abs(off_mm) > settings_.max_depth_share * usual) {
            const bool far = off_mm > 0;
            advice.why = fmt::format("It is {:.0f} cm {} the poses so far: out of the working volume.",
                                     std::abs(off_mm) / 10, far ? "behind" : "before");
            advice.what =
                fmt::format("Bring it {}, by about {:.0f} cm.", far ? "nearer to the cameras" : "farther away",
                            (std::abs(off_mm) - 0.5 * settings_.max_depth_share * usual) / 10);
            advice.in_light = far ? "NEARER" : "FARTHER";
            return far ? PoseFault::too_far : PoseFault::too_near;
        }
    }
    if (const double share = share_in_light(stance); share < settings_.least_in_light) {
        advice.why = fmt::format("The projector lights only {:.0f} % of it.", 100 * share);
        advice.what = "Bring it into the middle of the projector's light.";
        advice.in_light = "INTO THE LIGHT";
        return PoseFault::beside_light;
    }
    if (stance.tilt.norm() < settings_.least_tilt) {
        advice.why = fmt::format("It is nearly flat on (tilted by {:.0f} degrees): that says little of a lens.",
                                 stance.tilt.norm() * kDegrees);
        return PoseFault::flat_on;  // what to do: what is wanted most
    }
    for (std::size_t i = 0; i < poses_.size(); ++i) {
        const auto& there = poses_[i].stance;
        const Vector3d middle = middle_of(board_);
        if (!there || angle_between_faces(stance, *there) > settings_.alike_angle ||
            (stance.left_from_board * middle - there->left_from_board * middle).norm() > settings_.alike_mm)
            continue;
        advice.why = fmt::format("It lies as in pose {}: that tells nothing new.", i + 1);
        return PoseFault::alike;
    }
    return PoseFault::none;
}

PoseFault PoseGuide::fault_of(const BoardSighting& sighting, PoseAdvice& advice) const {
    const bool in_left = sighting.left.corners.size() > 0, in_right = sighting.right.corners.size() > 0;
    if (!in_left && !in_right) {
        advice.why = "No camera sees the board.";
        advice.what = "Hold it where both cameras and the projector look, its print towards them.";
        advice.in_light = "BOARD HERE";
        return PoseFault::not_seen;
    }
    if (!in_left || !in_right) {
        const char *sees = in_left ? "left" : "right", *misses = in_left ? "right" : "left";
        advice.why = fmt::format("Only the {} camera sees the board.", sees);
        advice.what = fmt::format("Bring it to where the {} camera sees it too, and turn its face less aside.", misses);
        advice.in_light = fmt::format("{} CAMERA BLIND", in_left ? "RIGHT" : "LEFT");
        return PoseFault::one_camera;
    }
    for (const auto& [view, camera] : {std::pair{&sighting.left, "left"}, std::pair{&sighting.right, "right"}})
        if (const PoseFault fault = fault_of_view(*view, camera, advice); fault != PoseFault::none) return fault;
    const auto [left, right] = lenses(sighting);
    advice.stance = stance_of(sighting.left.corners, sighting.right.corners, left, right, board_);
    if (!advice.stance) {
        advice.why = "How the board stands cannot be told.";
        advice.what = "Hold it so that both cameras see all of it.";
        advice.in_light = "BOARD HERE";
        return PoseFault::in_part;
    }
    return fault_of_stance(*advice.stance, advice);
}

PoseAdvice PoseGuide::look(const BoardSighting& sighting) {
    PoseAdvice advice;
    advice.still_share = still_share(sighting);
    advice.still = advice.still_share >= 1;
    advice.fault = fault_of(sighting, advice);
    // A board that moves is blurred by that alone.
    if (advice.fault == PoseFault::blurred && !advice.still) {
        advice.fault = PoseFault::none;
        advice.why.clear();
    }
    if (advice.fault == PoseFault::none) {
        advice.what = "Hold it still.";
        advice.in_light = "HOLD STILL";
        advice.capture = advice.still;
    } else if (advice.what.empty()) {
        advise(advice);
    }
    return advice;
}

}  // namespace planlight
